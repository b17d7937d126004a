#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "dynasurf/ventricle/measures/measures.hpp"
#include "dynasurf/ventricle/measures/normal_limits.hpp"

namespace dynasurf {

/// What normal limits, scores and comparisons need of a finished study.
struct PolarTable {
  PolarGrid grid;
  PolarMaps maps;  // those that the file holds; perfusion always
  std::vector<double> area_mm2;
};

/// Reads measures/polar.csv of a result. Throws InputError naming the file and the line, IoError.
PolarTable read_polar(const std::filesystem::path& csv);

/// A normal map as a file (schema dynasurf.normals/1): `studies`, `rings`, `sectors`, `mean` and `sd`, ring by ring
/// from the apex; null where there is none.
std::string normals_text(const NormalMap& normal);
NormalMap read_normals(const std::filesystem::path& path);

/// A person's scores: {"17": 2, "4": 0}. Sets them in `scores`. Throws InputError naming the file.
void read_scores(const std::filesystem::path& path, SegmentScores& scores);

}  // namespace dynasurf
