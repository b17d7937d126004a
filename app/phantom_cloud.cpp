#include <nlohmann/json.hpp>

#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/terrain.hpp"

#include "console.hpp"
#include "phantom_parts.hpp"
#include "version.hpp"

namespace dynasurf::app {

using Json = nlohmann::ordered_json;

ExitCode make_scan(const PhantomArguments& arguments, std::stop_token stop) {
  if (arguments.nrrd) throw OptionError("--nrrd: the phantom 'cloud' is no volume");
  const synthetic::CloudPhantom options = options_from<synthetic::CloudPhantom>(arguments);
  io::OutputFolder folder(arguments.out.path, arguments.out.existing());
  const TriMesh reference = synthetic::cloud_reference(options.shape);
  const PointCloud cloud = synthetic::make_cloud(options);
  io::write_cloud(cloud, folder.path() / "cloud.ply");
  io::write_mesh(reference, folder.path() / "truth" / "surface.ply", io::MeshFormat::ply);
  Json json = Json::object();
  json["schema"] = "dynasurf.phantom/1";
  json["kind"] = "cloud";
  json["points"] = cloud.points.size();
  json["genus"] = synthetic::genus_of(options.shape);
  // In the cloud's own unit, whatever it is.
  json["volume"] = mesh::volume_mm3(reference);
  json["area"] = mesh::area_mm2(reference);
  json["triangles"] = reference.triangles.size();
  json["program"] = {{"name", "dynasurf"}, {"version", version()}, {"commit", commit()}};
  json["options"] = io::parse_json(io::options_to_text(options), "the options");
  io::write_file(folder.path() / "truth.json", io::json_text(json));
  if (stop.stop_requested()) throw Cancelled("stopped on request");
  folder.publish();
  if (!arguments.quiet)
    print(std::string(word_of(options.shape)) + ": " + std::to_string(cloud.points.size()) + " points, genus " +
          std::to_string(synthetic::genus_of(options.shape)) + "\nphantom: " + arguments.out.path + "\n" +
          line_of_moved(folder));
  return done;
}

ExitCode make_terrain(const PhantomArguments& arguments, std::stop_token stop) {
  if (arguments.nrrd) throw OptionError("--nrrd: the phantom 'terrain' is no volume");
  if (!arguments.seed.empty()) throw OptionError("--seed: the phantom 'terrain' draws no random numbers");
  synthetic::Terrain options = options_from<synthetic::Terrain>(arguments);
  // The truth is the same terrain without its spikes.
  synthetic::Terrain hills = options;
  hills.spike_every = 0;
  io::OutputFolder folder(arguments.out.path, arguments.out.existing());
  const TriMesh terrain = synthetic::make_terrain(options), truth = synthetic::make_terrain(hills);
  io::write_mesh(terrain, folder.path() / "terrain.ply", io::MeshFormat::ply);
  io::write_mesh(truth, folder.path() / "truth" / "surface.ply", io::MeshFormat::ply);
  std::size_t spikes = 0;
  for (std::size_t v = 0; v < truth.vertices.size(); ++v) spikes += terrain.vertices[v] != truth.vertices[v] ? 1 : 0;
  Json json = Json::object();
  json["schema"] = "dynasurf.phantom/1";
  json["kind"] = "terrain";
  json["vertices"] = truth.vertices.size();
  json["triangles"] = truth.triangles.size();
  json["spikes"] = spikes;
  json["program"] = {{"name", "dynasurf"}, {"version", version()}, {"commit", commit()}};
  json["options"] = io::parse_json(io::options_to_text(options), "the options");
  io::write_file(folder.path() / "truth.json", io::json_text(json));
  if (stop.stop_requested()) throw Cancelled("stopped on request");
  folder.publish();
  if (!arguments.quiet)
    print("terrain: " + std::to_string(truth.vertices.size()) + " vertices, " + std::to_string(spikes) +
          " spikes\nphantom: " + arguments.out.path + "\n" + line_of_moved(folder));
  return done;
}

}  // namespace dynasurf::app
