#include "dynasurf/report/normals.hpp"

#include "dynasurf/report/detail/normal_groups.hpp"

#include "input_files.hpp"
#include "target.hpp"

namespace dynasurf::fuzz {

/// Files of a user that are JSON: by its first byte a normal map or those of groups, the scores of a reader, or the two
/// files of a result that tell its polar map, with a line "----" between them.
bool run_normals(std::string_view bytes) {
  if (bytes.empty()) return false;
  const int kind = static_cast<unsigned char>(bytes[0]) % 3;
  bytes.remove_prefix(1);
  InputFiles files;
  if (kind == 0) {
    const auto path = files.add("normals.json", bytes);
    return reads(path.string(), [&] {
      const ventricle::NormalMap map = report::read_normal_groups(path).all;
      require(map.mean.size() == map.grid.size() && map.sd.size() == map.grid.size(), "a map has all its samples");
    });
  }
  if (kind == 1) {
    const auto path = files.add("scores.json", bytes);
    return reads(path.string(), [&] {
      ventricle::SegmentScores scores{std::vector<std::optional<int>>(17), std::vector<bool>(17)};
      report::read_scores(path, scores);
    });
  }
  constexpr std::string_view border = "----\n";
  const std::size_t end = bytes.find(border);
  files.add("results.json", bytes.substr(0, end));
  files.add("measures/polar.csv", end == std::string_view::npos ? "" : bytes.substr(end + border.size()));
  return reads(files.folder(), [&] { report::read_polar(files.folder()); });
}

}  // namespace dynasurf::fuzz
