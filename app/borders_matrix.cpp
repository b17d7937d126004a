#include "borders_matrix.hpp"

#include <algorithm>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/show/detail/sheets.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

/// "edges.sigma_px=1,2" as "edges.sigma_px=1" and "edges.sigma_px=2".
std::vector<std::string> values_of(const std::string& vary) {
  const auto equal = vary.find('=');
  if (equal == std::string::npos || equal == 0 || equal + 1 == vary.size())
    throw OptionError("--vary " + vary + ": expected path=value,value,...");
  std::vector<std::string> all;
  for (std::size_t from = equal + 1; from <= vary.size();) {
    const std::size_t to = std::min(vary.find(',', from), vary.size());
    if (to == from) throw OptionError("--vary " + vary + ": a value is empty");
    all.push_back(vary.substr(0, equal + 1) + vary.substr(from, to - from));
    from = to + 1;
  }
  return all;
}

/// A whole is set before its parts, so that `edges=compass` does not undo `edges.low=0.1`.
void sort_by_depth(std::vector<std::string>& settings) {
  const auto depth = [](const std::string& s) { return std::count(s.begin(), s.begin() + s.find('='), '.'); };
  for (const std::string& s : settings)
    if (s.find('=') == std::string::npos) throw OptionError("--set " + s + ": expected path=value");
  std::stable_sort(settings.begin(), settings.end(),
                   [&](const std::string& a, const std::string& b) { return depth(a) < depth(b); });
}

}  // namespace

void write_matrix(const BordersArguments& arguments, Drawing what, const Image* mask, const fs::path& folder,
                  const Progress& progress) {
  if (arguments.vary.size() > 2) throw OptionError("--vary was given more than twice; expected columns and rows");
  Study study = io::read_study(arguments.study, arguments.series);
  study.gates = {std::move(study.gates[gate_of(arguments, study) - 1])};
  study.time_ms.clear();

  const std::vector<std::string> across = values_of(arguments.vary[0]), down = arguments.vary.size() > 1
                                                                                   ? values_of(arguments.vary[1])
                                                                                   : std::vector<std::string>{""};
  std::vector<std::vector<show::MatrixCell>> rows;
  int done = 0;
  for (const std::string& row : down) {
    rows.emplace_back();
    for (const std::string& column : across) {
      OptionArguments with = arguments.options;
      with.settings.push_back(column);
      if (!row.empty()) with.settings.push_back(row);
      sort_by_depth(with.settings);
      const std::string name =
          column.substr(column.find('=') + 1) + (row.empty() ? "" : " " + row.substr(row.find('=') + 1));
      rows.back().push_back(
          {name, ventricle::find_borders(study, options_of(with), {{}, progress.stop}, {.mask = mask})});
      progress("choices", ++done, across.size() * down.size());
    }
  }
  const ventricle::BorderResult& first = rows[0][0].borders;
  const int slice = arguments.slice > 0 ? arguments.slice - 1
                                        : (first.gates[0].labels.division_slice + first.gates[0].base_slice + 1) / 2;
  if (slice >= first.study.grid().dims[2])
    throw OptionError("--slice " + std::to_string(slice + 1) + ": the stack has " +
                      std::to_string(first.study.grid().dims[2]));
  std::string title = "gate " + std::to_string(arguments.gate) + ", slice " + std::to_string(slice + 1) + ": " +
                      arguments.vary[0].substr(0, arguments.vary[0].find('='));
  if (arguments.vary.size() > 1) title += " by " + arguments.vary[1].substr(0, arguments.vary[1].find('='));
  show::write_drawing(
      show::draw_matrix(rows, slice, what == Drawing::edges ? show::MatrixDrawing::edges : show::MatrixDrawing::labels,
                        title),
      folder / "matrix.png", show::DrawingFormat::png);
}

}  // namespace dynasurf::app
