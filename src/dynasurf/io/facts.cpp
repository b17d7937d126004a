#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/formats.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io {
namespace {

std::string number(double value, int digits = 6) {
  std::array<char, 40> buffer;
  std::snprintf(buffer.data(), buffer.size(), "%.*g", digits, value);
  return buffer.data();
}

std::string words_of(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

/// Where an axis leads in the patient, by its angles: "left", or "left, 30 degrees towards superior".
std::string heading_of(const Vec3& axis) {
  constexpr const char* names[3][2] = {{"right", "left"}, {"anterior", "posterior"}, {"inferior", "superior"}};
  std::array<Eigen::Index, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return std::abs(axis[a]) > std::abs(axis[b]); });
  const auto name = [&](Eigen::Index n) { return std::string(names[n][axis[n] > 0 ? 1 : 0]); };
  constexpr double degrees = 57.29577951308232;
  const double tilt = own::acos(std::min(1.0, std::abs(axis[order[0]]))) * degrees;
  if (tilt < 0.5) return name(order[0]);
  return name(order[0]) + ", " + number(std::round(tilt), 3) + " degrees towards " + name(order[1]);
}

double sum_of(const Image& image) {
  double sum = 0;
  for (const float v : image.values) sum += v;
  return sum;
}

// What the reconstruction works on at least.
constexpr int least_pixels = 8, least_slices = 3;

bool is_flat(const Study& study) {
  const float first = study.gates.front().values.front();
  return std::all_of(study.gates.begin(), study.gates.end(), [&](const Image& gate) {
    return std::all_of(gate.values.begin(), gate.values.end(), [&](float v) { return v == first; });
  });
}

std::string what_follows(const Study& study) {
  const Index3& n = study.grid().dims;
  if (n[0] < least_pixels || n[1] < least_pixels || n[2] < least_slices)
    return "refuse: at least " + std::to_string(least_pixels) + " x " + std::to_string(least_pixels) + " pixels in " +
           std::to_string(least_slices) + " slices are needed";
  if (is_flat(study)) return "find nothing and end with the verdict fail: every voxel has the same value";
  const bool is_square = study.view == View::short_axis || study.view == View::unknown;
  const std::string how = study.view == View::unknown ? ", taking the slices as short-axis unless the wall leans"
                          : is_square                 ? ""
                                                      : ", cutting the " + words_of(name_of(study.view)) +
                                            " slices anew across the ventricle; refuse if none is found";
  if (study.gates.size() == 1)
    return "look for both surfaces and their volumes; no ejection fraction, because the study is not gated" + how;
  return "look for both surfaces of " + std::to_string(study.gates.size()) +
         " gates, their volumes and the ejection fraction" + how;
}

}  // namespace

StudyFacts facts_of(const std::filesystem::path& path, const Study& study, const std::string& series) {
  if (study.gates.empty()) throw InputError(path.string() + ": the study has no volume");
  StudyFacts facts;
  const auto add = [&](const std::string& name, const std::string& value) { facts.rows.emplace_back(name, value); };
  const Grid& g = study.grid();
  add("format", study.format);
  add("modality", study.modality.empty() ? "not in the file" : study.modality);
  if (!study.image_type.empty()) add("image type", study.image_type);
  add("view", words_of(name_of(study.view)));
  add("slice order", words_of(name_of(study.slice_order)));
  if (study.attenuation != Attenuation::unknown) add("attenuation", std::string(name_of(study.attenuation)));
  add("voxels", std::to_string(g.dims[0]) + " x " + std::to_string(g.dims[1]) + " x " + std::to_string(g.dims[2]));
  add("voxel size", number(g.spacing[0]) + " x " + number(g.spacing[1]) + " x " + number(g.spacing[2]) + " mm");
  add("extent", number(g.spacing[0] * g.dims[0], 4) + " x " + number(g.spacing[1] * g.dims[1], 4) + " x " +
                    number(g.spacing[2] * g.dims[2], 4) + " mm");
  add("first voxel", "left " + number(g.origin[0]) + ", posterior " + number(g.origin[1]) + ", superior " +
                         number(g.origin[2]) + " mm");
  add("columns lead to", heading_of(g.direction.col(0)));
  add("rows lead to", heading_of(g.direction.col(1)));
  add("slices lead to", heading_of(g.direction.col(2)));
  if (g.direction.determinant() < 0) add("handedness", "left-handed (negative slice spacing)");

  add("gates", study.gates.size() == 1 ? "1 (not gated)" : std::to_string(study.gates.size()));
  if (study.cycle_ms > 0)
    add("heart cycle", number(study.cycle_ms) + " ms (" + number(60000 / study.cycle_ms, 3) + " /min)");
  if (!study.time_ms.empty()) {
    std::string times;
    for (const double t : study.time_ms) times += (times.empty() ? "" : " ") + number(t, 4);
    add("gates start at", times + " ms");
  }
  if (study.format == "DICOM")
    for (const auto& row : dicom_facts(path, series)) facts.rows.push_back(row);

  double total = 0;
  std::string per_gate;
  float least = study.gates.front().values.front(), most = least;
  for (const Image& gate : study.gates) {
    const double sum = sum_of(gate);
    total += sum;
    per_gate += (per_gate.empty() ? "" : " ") + number(sum, 7);
    const auto [low, high] = std::minmax_element(gate.values.begin(), gate.values.end());
    least = std::min(least, *low);
    most = std::max(most, *high);
  }
  add("sum of values", number(total, 9));
  if (study.gates.size() > 1) add("sum per gate", per_gate);
  add("values", number(least) + " to " + number(most));
  add("dynasurf ventricle would", what_follows(study));
  return facts;
}

}  // namespace dynasurf::io
