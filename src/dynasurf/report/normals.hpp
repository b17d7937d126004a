#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "dynasurf/ventricle/measures/measures.hpp"
#include "dynasurf/ventricle/measures/normal_limits.hpp"

namespace dynasurf::report {

/// What normal limits, scores and comparisons need of a finished study.
struct PolarTable {
  ventricle::PolarGrid grid;
  ventricle::PolarMaps
      maps;  // those that the file holds; perfusion always, without any value where `perfusion_is` none
  ventricle::Perfusion perfusion_is = ventricle::Perfusion::none;
  std::vector<double> area_mm2;
};

/// Reads measures/polar.csv of a result, and in its results.json what its perfusion is made of. Throws InputError
/// naming the file and the line, IoError.
PolarTable read_polar(const std::filesystem::path& result);

/// Throws InputError unless both perfusions are of one kind, and there is any: "A has perfusion from counts, B from
/// uptake".
void require_same_perfusion(ventricle::Perfusion a, const std::string& name_a, ventricle::Perfusion b,
                            const std::string& name_b);

/// A normal map as a file (schema dynasurf.normals/1): `studies`, `perfusion_is` (counts or uptake), `rings`,
/// `sectors`, `mean` and `sd`, ring by ring from the apex; null where there is none.
std::string normals_text(const ventricle::NormalMap& normal);
ventricle::NormalMap read_normals(const std::filesystem::path& path);

/// A person's scores: {"17": 2, "4": 0}. Sets them in `scores`. Throws InputError naming the file.
void read_scores(const std::filesystem::path& path, ventricle::SegmentScores& scores);

}  // namespace dynasurf::report
