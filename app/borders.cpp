#include <memory>

#include <CLI/CLI.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/atomic_file.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "command.hpp"
#include "console.hpp"
#include "option_arguments.hpp"
#include "sheets.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string study, out;
  OptionArguments options;
  int threads = 0;
  bool quiet = false;
};

int count_slices(const Mask& mask, int bits) {
  int slices = 0;
  const std::size_t area = mask.grid.size() / static_cast<std::size_t>(std::max(1, mask.grid.dims[2]));
  for (std::size_t begin = 0; begin < mask.values.size(); begin += area) {
    bool any = false;
    for (std::size_t n = begin; n < begin + area; ++n) any |= (mask.values[n] & bits) != 0;
    slices += any;
  }
  return slices;
}

std::string table_of_edges(const BorderResult& result) {
  std::vector<std::vector<std::string>> rows{{"gate", "edge pixels", "slices with edges"}};
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const Mask& edges = result.gates[g].edges.edges;
    const auto pixels = std::count_if(edges.values.begin(), edges.values.end(), [](auto v) { return v != 0; });
    rows.push_back({std::to_string(g + 1), std::to_string(pixels), std::to_string(count_slices(edges, 3))});
  }
  return table(rows);
}

std::string table_of_borders(const BorderResult& result) {
  std::vector<std::vector<std::string>> rows{
      {"gate", "circle, px", "division slice", "big slice", "slices with endo", "slices with epi"}};
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const Labels& labels = result.gates[g].labels;
    const auto slice = [](int k) { return k < 0 ? std::string("-") : std::to_string(k + 1); };
    rows.push_back({std::to_string(g + 1), fixed(labels.circle.radius_px, 1), slice(labels.division_slice),
                    slice(labels.big_slice), std::to_string(count_slices(labels.borders, Labels::endo_bit)),
                    std::to_string(count_slices(labels.borders, Labels::epi_bit))});
  }
  return table(rows);
}

enum class Drawing { edges, borders };

void write_sheets(const BorderResult& result, Drawing what, const fs::path& folder, const VentricleOptions& options) {
  const RadialLabels* asked = std::get_if<RadialLabels>(&options.labels.method);
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const GateBorders& gate = result.gates[g];
    const Image& image = result.study.gates[g];
    const std::string prefix = (folder / ((g < 9 ? "g0" : "g") + std::to_string(g + 1))).string();
    write_png(draw_edges(image, gate.edges), prefix + "_edges.png");
    if (what == Drawing::edges) continue;
    write_png(draw_labels(image, gate, result.coarse), prefix + "_labels.png");
    write_png(draw_rings(image, gate, asked ? *asked : RadialLabels{}), prefix + "_rings.png");
  }
}

ExitCode run(const Arguments& arguments, Drawing what, std::stop_token stop) {
  // Only what this command wrote before is replaced.
  OutputFolder folder(arguments.out, fs::exists(fs::path(arguments.out) / "g01_edges.png"));
  const VentricleOptions options = options_of(arguments.options);
  const ThreadLimit limit(arguments.threads);
  ProgressLine line(arguments.quiet);
  const Progress progress{[&](std::string_view stage, int done, int total) { line(stage, done, total); }, stop};
  std::optional<Image> mask;
  if (!arguments.options.mask.empty()) mask = read_mask(arguments.options.mask);
  const BorderResult result = find_borders(read_study(arguments.study), options, progress, mask ? &*mask : nullptr);
  line.finish();
  write_sheets(result, what, folder.path(), options);
  write_file(folder.path() / "options.json", options_to_text(options));
  folder.publish();

  std::string text = what == Drawing::edges ? table_of_edges(result) : table_of_borders(result);
  bool failed = false;
  for (const Note& note : result.notes) {
    failed |= note.severity == Severity::failure;
    if (what == Drawing::borders && note.severity != Severity::info) text += line_of(note) + "\n";
  }
  print(text + "sheets: " + arguments.out + "\n");
  return what == Drawing::borders && failed ? not_trustworthy : done;
}

void add(CLI::App& program, Command& chosen, Drawing what, const std::string& name, const std::string& text) {
  auto a = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand(name, text);
  command->add_option("STUDY", a->study, "DICOM file or folder, NIfTI or NRRD file")->required();
  command->add_option("--out", a->out, "folder for the sheets; former sheets there are replaced")->required();
  add_option_arguments(*command, a->options);
  command->add_option("--threads", a->threads, "threads at most; the result is the same (0: all)")
      ->check(CLI::Range(0, 1024));
  command->add_flag("--quiet", a->quiet, "no progress on standard error");
  command->callback([a, what, &chosen] { chosen = [a, what](std::stop_token stop) { return run(*a, what, stop); }; });
}

}  // namespace

void add_edges(CLI::App& program, Command& chosen) {
  add(program, chosen, Drawing::edges, "edges", "Find the edges of every slice and draw them as PNG sheets");
}

void add_borders(CLI::App& program, Command& chosen) {
  add(program, chosen, Drawing::borders, "borders",
      "Find the edges and label the borders of every gate, and draw both as PNG sheets");
}

}  // namespace dynasurf::app
