#include "dynasurf/organ/organ.hpp"

#include <filesystem>
#include <memory>

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/digest.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"

#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "option_arguments.hpp"
#include "out_argument.hpp"
#include "section_sheet.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

using Json = nlohmann::ordered_json;

struct OrganArguments {
  std::string study, series, preset = "ct";
  OutFolder out;
  std::vector<std::string> settings;
  std::optional<int> label;
  int gate = 1, threads = 0;
  bool quiet = false;
};

organ::Options options_of(const OrganArguments& a) {
  organ::Options options = organ::preset(a.preset);
  set_options(options, a.settings);
  if (a.label) options.source = organ::Source::labels, options.label = *a.label;
  return options;
}

Json surface_json(const std::optional<ventricle::Surface>& surface) {
  if (!surface) return nullptr;
  const mesh::Repair& repair = surface->repair;
  return {{"volume_ml", surface->volume_ml},
          {"area_mm2", mesh::area_mm2(surface->mesh)},
          {"vertices", surface->mesh.vertices.size()},
          {"stop_reason", std::string(dynamics::name_of(surface->stop_reason))},
          {"border_reached", surface->border_reached},
          {"shape_min", surface->quality.shape_min},
          {"closed", repair.check.closed},
          {"manifold", repair.check.manifold},
          {"self_intersections", repair.check.self_intersections}};
}

/// A surface that is open, cuts itself or flew apart encloses no volume.
bool is_trustworthy(const organ::Result& result) {
  return result.surface && result.surface->stop_reason != dynamics::StopReason::diverged &&
         result.surface->repair.check.closed && result.surface->repair.check.self_intersections == 0;
}

Json result_json(const organ::Result& result, const organ::Options& options, const Study& study) {
  Json json = Json::object();
  json["schema"] = "dynasurf.organ/1";
  json["use"] = "Research use only. Not for diagnosis.";
  json["surface"] = surface_json(result.surface);
  json["voxels_ml"] = result.voxels_ml;
  json["threshold"] = result.threshold;
  json["notes"] = Json::array();
  for (const Note& note : result.notes)
    json["notes"].push_back({{"severity", name_of(note.severity)}, {"code", note.code}, {"message", note.message}});
  json["study"] = {{"format", study.format}, {"modality", study.modality}, {"dims", study.grid().dims}};
  json["program"] = {{"name", "dynasurf"}, {"version", version()}, {"commit", commit()}};
  json["options"] = io::parse_json(io::options_to_text(options), "the options");
  return json;
}

ExitCode run(const OrganArguments& a, std::stop_token stop) {
  const ThreadLimit limit(a.threads);
  const organ::Options options = options_of(a);
  const Study study = io::read_study(a.study, a.series);
  if (a.gate > static_cast<int>(study.gates.size()))
    throw OptionError("--gate " + std::to_string(a.gate) + "; expected 1 to " + std::to_string(study.gates.size()));
  io::OutputFolder folder(a.out.path, a.out.existing(), {a.study});
  const organ::Result result = organ::reconstruct(study.gates[a.gate - 1], options, {{}, stop});
  io::write_file(folder.path() / "results.json", io::json_text(result_json(result, options, study)));
  if (result.surface)
    for (const io::MeshFormat format : {io::MeshFormat::ply, io::MeshFormat::stl, io::MeshFormat::vtp})
      io::write_mesh(result.surface->mesh, folder.path() / ("organ." + std::string(word_of(format))), format);
  if (result.surface)
    write_section_sheet(study.gates[a.gate - 1], result.surface->mesh,
                        "Organ: " + fixed(result.surface->volume_ml, 1) + " mL", folder.path() / "slices.png");
  folder.publish();
  if (!a.quiet) {
    std::string text;
    if (result.surface)
      text = table({{"volume_ml", fixed(result.surface->volume_ml, 2)},
                    {"voxels_ml", fixed(result.voxels_ml, 2)},
                    {"area_mm2", fixed(mesh::area_mm2(result.surface->mesh), 0)},
                    {"vertices", std::to_string(result.surface->mesh.vertices.size())}},
                   {0});
    for (const Note& note : result.notes) text += line_of(note) + "\n";
    print(text + "Research use only. Not for diagnosis.\nresult: " + a.out.path + "\n" + line_of_moved(folder));
  }
  return is_trustworthy(result) ? done : not_trustworthy;
}

}  // namespace

void add_organ(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<OrganArguments>();
  CommandLine command(program, "organ",
                      "The closed surface of an organ in CT, MR, PET or a label map: no heart is looked for");
  command.option("STUDY", a->study, "DICOM, NIfTI or NRRD, file or folder").required();
  add_series_argument(command, a->series);
  add_out_folder(command, a->out, "folder for results.json, organ.ply, .stl, .vtp and slices.png").required();
  command.option("--preset", a->preset, "ct, mr, pet or labels");
  command.option("--label", a->label, "value of the organ in a label map; 0: all above 0").within(0, 1000000);
  command.option("--gate", a->gate, "which image of a gated study, from 1").within(1, 1000);
  command.option("--set", a->settings, "set one option: path=value; may be repeated (see: dynasurf options organ)")
      .repeated();
  command.option("--threads", a->threads, "0: as many as the machine has").within(0, 1024);
  command.flag("--quiet", a->quiet, "print nothing");
  command.run(chosen, [a](std::stop_token stop) { return run(*a, stop); });
}

}  // namespace dynasurf::app
