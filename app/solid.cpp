#include <filesystem>
#include <memory>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/ventricle/measures/wall_solid.hpp"

#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "out_argument.hpp"
#include "result_walls.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

struct SolidArguments {
  std::string result;
  OutFile out;
  int gate = 1;
  bool edges = false;
  ventricle::WallSolidSize size;
};

io::SolidFormat format_of(const fs::path& path) {
  const std::string ending = path.extension().string();
  for (std::size_t n = 0; n < io::names_of(io::SolidFormat{}).size(); ++n)
    if (ending == "." + std::string(io::names_of(io::SolidFormat{})[n])) return static_cast<io::SolidFormat>(n);
  throw OptionError("--out " + path.string() + ": expected a name that ends with .vtu, .msh or .inp");
}

ExitCode run(const SolidArguments& a) {
  const io::SolidFormat format = format_of(a.out.path);
  io::OutputFile output(a.out.path, a.out.existing());
  const auto [endo, epi, axes, is_fitted] = read_result_walls(a.result, a.gate, a.edges);
  const auto solid = axes ? ventricle::wall_solid(endo, epi, *axes, a.size) : std::nullopt;
  if (!solid)
    throw InputError("the wall of gate " + std::to_string(a.gate) +
                     " cannot be filled: its surfaces cross, or are not seen from the axis");
  const std::vector<io::VertexScalar> scalars{{"ring", {solid->ring.begin(), solid->ring.end()}},
                                              {"layer", {solid->layer.begin(), solid->layer.end()}}};
  io::write_solid(solid->mesh, output.path(), format, scalars);
  output.publish();
  print(table({{"surfaces", is_fitted ? "PSF-corrected" : "edge"},
               {"tetrahedra", std::to_string(solid->quality.count)},
               {"not positive", std::to_string(solid->quality.not_positive)},
               {"volume_ml", fixed(solid->volume_ml, 3)},
               {"between the surfaces_ml", fixed(solid->surfaces_ml, 3)},
               {"moved to hold it_mm", fixed(solid->moved_mm, 3)},
               {"ends below the valve plane_mm", fixed(solid->lowered_mm, 1)},
               {"shape_min", fixed(solid->quality.shape_min, 3)},
               {"shape_mean", fixed(solid->quality.shape_mean, 3)}},
              {0}) +
        line_of_moved(output));
  // Finite elements need tetrahedra of positive volume.
  return solid->quality.not_positive == 0 ? done : not_trustworthy;
}

}  // namespace

void add_solid(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<SolidArguments>();
  CommandLine command(program, "solid", "Fill the wall of one gate of a result with tetrahedra, for mechanics");
  command.option("RESULT", a->result, "folder written by dynasurf ventricle").required();
  command.option("--gate", a->gate, "from 1").within(1, 1000);
  command.flag("--edges", a->edges, "the surfaces of the edges, also where walls were fitted through the blur");
  add_out_file(command, a->out, "wall.vtu (VTK), wall.msh (gmsh 2.2) or wall.inp (Abaqus)").required();
  command.option("--rings", a->size.rings, "from apex to base").within(2, 500);
  command.option("--sectors", a->size.sectors, "around the axis").within(3, 1000);
  command.option("--layers", a->size.layers, "through the wall").within(1, 50);
  command.run(chosen, [a](std::stop_token) { return run(*a); });
}

}  // namespace dynasurf::app
