// Where does the cavity end? The division slice of the virtual patients of borders_200 against the truth.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "dynasurf/ventricle/labels/detail/mlc.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "../borders_200/patients.hpp"

namespace {

using namespace dynasurf;

constexpr double ring_deg = 120;  // an inner border that goes so far around the axis shows a cavity

/// Slice by slice: how far above the truth, of what the inner border shows and of what the labelling says.
struct Errors {
  std::vector<int> inner_border, division_slice;
  void add(int border, int slice) { inner_border.push_back(border), division_slice.push_back(slice); }
};

Vec3 axis_of(const Patient& patient, const Grid& grid) {
  const double t = patient.options.pose.tilt_deg * M_PI / 180, a = patient.options.pose.tilt_towards_deg * M_PI / 180;
  Mat3 direction = grid.direction;
  if (patient.options.base_first) direction.col(2) *= -1;
  return direction * Vec3(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t));
}

/// The highest slice whose middle lies below the lowest point of the true cavity along the axis.
int true_slice(const TriMesh& endo, const Vec3& axis, const Grid& grid) {
  const Vec3 tip = *std::min_element(endo.vertices.begin(), endo.vertices.end(),
                                     [&](const Vec3& a, const Vec3& b) { return a.dot(axis) < b.dot(axis); });
  return static_cast<int>(std::floor(to_grid(grid, tip)[2] / grid.spacing[2]));
}

/// The slice under the lowest one that shows both borders; -1 where none does.
int under_inner_border(const ventricle::Labels& labels) {
  for (int k = 0; k < labels.borders.grid.dims[2]; ++k)
    if (ventricle::count_borders(labels.borders, k, labels.axis, ring_deg) == 2) return k - 1;
  return -1;
}

void examine(int number, Errors& errors) {
  Patient patient = draw_patient(number);
  patient.options.gates = 2;  // the relaxed and the emptied heart
  const synthetic::Phantom phantom = scan(patient);
  const Vec3 axis = axis_of(patient, phantom.study.grid());
  const ventricle::BorderResult result = ventricle::find_borders(phantom.study, {});
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const ventricle::Labels& labels = result.gates[g].labels;
    const int truth = true_slice(phantom.truth[g].endo, axis, result.study.grid());
    errors.add(under_inner_border(labels) - truth, labels.division_slice - truth);
  }
}

void print(const char* name, const std::vector<int>& errors) {
  const auto count = [&](const auto& is) {
    return errors.empty() ? 0
                          : 100.0 * static_cast<double>(std::count_if(errors.begin(), errors.end(), is)) /
                                static_cast<double>(errors.size());
  };
  std::printf(
      "  %-20s exact %5.1f %%  within 1: %5.1f %%  higher by 2: %5.1f %%  by 3 or more: %5.1f %%  lower: %5.1f %%\n",
      name, count([](int e) { return e == 0; }), count([](int e) { return std::abs(e) <= 1; }),
      count([](int e) { return e == 2; }), count([](int e) { return e > 2; }), count([](int e) { return e < -1; }));
}

}  // namespace

int main() {
  std::array<Errors, 4> groups;  // half, then whether the defect is one of the apex
  std::vector<Errors> each(200);
  for (int n = 0; n < 200; ++n) examine(n, each[static_cast<std::size_t>(n)]);
  for (int n = 0; n < 200; ++n) {
    const synthetic::Defect defect = draw_patient(n).options.defect;
    const bool apical = defect == synthetic::Defect::apical || defect == synthetic::Defect::anteroapical;
    Errors& group = groups[(n >= 100 ? 2U : 0U) + (apical ? 1U : 0U)];
    const Errors& one = each[static_cast<std::size_t>(n)];
    for (std::size_t g = 0; g < one.division_slice.size(); ++g) group.add(one.inner_border[g], one.division_slice[g]);
  }
  const std::array<const char*, 4> names{"choosing half, apex without defect", "choosing half, defect of the apex",
                                         "reporting half, apex without defect", "reporting half, defect of the apex"};
  for (std::size_t n = 0; n < groups.size(); ++n) {
    std::printf("%s: %zu gates\n", names[n], groups[n].division_slice.size());
    print("inner border alone", groups[n].inner_border);
    print("division slice", groups[n].division_slice);
  }
}
