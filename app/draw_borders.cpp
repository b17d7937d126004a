#include <algorithm>

#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/show/detail/border_sheets.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "borders_matrix.hpp"
#include "console.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

int count_slices(const Mask& mask, int bits) {
  int slices = 0;
  const std::size_t area = mask.grid.size() / std::max(1, mask.grid.dims[2]);
  for (std::size_t begin = 0; begin < mask.values.size(); begin += area) {
    bool any = false;
    for (std::size_t n = begin; n < begin + area; ++n) any |= (mask.values[n] & bits) != 0;
    slices += any;
  }
  return slices;
}

std::string table_of_edges(const ventricle::BorderResult& result) {
  std::vector<std::vector<std::string>> rows{{"gate", "edge pixels", "slices with edges"}};
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const Mask& edges = result.gates[g].edges.edges;
    const auto pixels = std::count_if(edges.values.begin(), edges.values.end(), [](auto v) { return v != 0; });
    rows.push_back({std::to_string(g + 1), std::to_string(pixels), std::to_string(count_slices(edges, 3))});
  }
  return table(rows);
}

std::string table_of_borders(const ventricle::BorderResult& result) {
  std::vector<std::vector<std::string>> rows{
      {"gate", "circle, px", "division slice", "big slice", "slices with endo", "slices with epi"}};
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const ventricle::Labels& labels = result.gates[g].labels;
    const auto slice = [](int k) { return k < 0 ? std::string("-") : std::to_string(k + 1); };
    rows.push_back({std::to_string(g + 1), fixed(labels.circle.radius_px, 1), slice(labels.division_slice),
                    slice(labels.big_slice), std::to_string(count_slices(labels.borders, ventricle::Labels::endo_bit)),
                    std::to_string(count_slices(labels.borders, ventricle::Labels::epi_bit))});
  }
  return table(rows);
}

}  // namespace

ExitCode draw_borders(const BordersArguments& arguments, std::stop_token stop) {
  const Drawing what = arguments.edges_only ? Drawing::edges : Drawing::borders;
  const fs::path out = arguments.out.path;
  // Nothing that is read may lie in the folder that is replaced.
  std::vector<fs::path> inputs{arguments.study};
  for (const std::string& given : {arguments.options.mask, arguments.options.file})
    if (!given.empty()) inputs.emplace_back(given);
  io::OutputFolder folder(out, arguments.out.existing(), inputs);
  const ventricle::Options options = options_of(arguments.options);
  ProgressLine line(arguments.quiet);
  const Progress progress{[&](std::string_view stage, int done, int total) { line(stage, done, total); }, stop};
  std::optional<Image> mask;
  if (!arguments.options.mask.empty()) mask = read_mask(arguments.options.mask);
  if (!arguments.vary.empty()) {
    write_matrix(arguments, what, mask ? &*mask : nullptr, folder.path(), progress);
    line.finish();
    io::write_file(folder.path() / "options.json", io::options_to_text(options));
    folder.publish();
    print("matrix: " + (out / "matrix.png").string() + "\n" + line_of_moved(folder));
    return done;
  }

  const ventricle::BorderResult result = ventricle::find_borders(io::read_study(arguments.study, arguments.series),
                                                                 options, progress, {.mask = mask ? &*mask : nullptr});
  line.finish();
  show::write_border_sheets(result, options, what == Drawing::borders, folder.path());
  io::write_file(folder.path() / "options.json", io::options_to_text(options));
  folder.publish();

  std::string text = what == Drawing::edges ? table_of_edges(result) : table_of_borders(result);
  bool failed = false;
  for (const Note& note : result.notes) {
    failed |= note.severity == Severity::failure;
    const bool is_of_the_study = note.gate < 0;  // which way the heart lies, how slices were cut anew
    if (is_of_the_study || (what == Drawing::borders && note.severity != Severity::info)) text += line_of(note) + "\n";
  }
  if (!arguments.quiet) print(text + "sheets: " + out.string() + "\n" + line_of_moved(folder));
  return what == Drawing::borders && failed ? not_trustworthy : done;
}

}  // namespace dynasurf::app
