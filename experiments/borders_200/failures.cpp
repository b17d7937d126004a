#include "failures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "dynasurf/heart/locate.hpp"
#include "dynasurf/synthetic/detail/noise.hpp"
#include "dynasurf/synthetic/detail/random.hpp"
#include "dynasurf/synthetic/detail/render.hpp"

namespace dynasurf {
namespace {

/// Some dice of the planted thing's own.
double dice(int number, int salt, double low, double high) {
  synthetic::Random random(777, static_cast<std::uint64_t>(number * 100 + salt));
  return low + (high - low) * random.uniform();
}

/// A short-axis patient without other trouble: the planted thing is the only one.
Patient plain_patient(int number) {
  Patient p = draw_patient(3 * number + 1);
  p.number = number;
  synthetic::VirtualPatient& o = p.options;
  p.has_defect = p.has_gut = false;
  o.defect = synthetic::Defect::none, o.gut_amplitude = 0, o.right_ventricle = std::min(o.right_ventricle, 0.3);
  o.edv_ml = std::clamp(o.edv_ml, 60.0, 220.0);
  o.wall_ml = 70 + 0.35 * o.edv_ml;
  o.ef_percent = std::clamp(o.ef_percent, 30.0, 75.0);
  o.base_excursion_mm = 0.16 * o.ef_percent;
  o.gates = 8;
  return p;
}

Image cropped(const Image& image, int axis, int first, int last) {
  Grid grid = image.grid;
  Index3 from{0, 0, 0};
  from[static_cast<std::size_t>(axis)] = first;
  grid.dims[static_cast<std::size_t>(axis)] = last - first + 1;
  grid.origin = to_world(image.grid, centre_of(image.grid, from));
  Image result(grid);
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) result(i, j, k) = image(i + from[0], j + from[1], k + from[2]);
  return result;
}

/// Cuts the field of view so that `part` of the heart's extent along a grid axis is lost, from the end in `direction`.
void cut(synthetic::Phantom& phantom, int axis, double part, const Vec3& direction) {
  const Grid grid = phantom.study.grid();
  double low = 1e9, high = -1e9;
  for (const Vec3& p : phantom.truth.front().epi.vertices) {
    const double x = to_grid(grid, p)[axis];
    low = std::min(low, x), high = std::max(high, x);
  }
  const bool upper = (grid.direction.transpose() * direction)[axis] > 0;
  const double at = upper ? high - part * (high - low) : low + part * (high - low);
  const int last = grid.dims[static_cast<std::size_t>(axis)] - 1;
  const int slice = std::clamp(static_cast<int>(std::lround(at / grid.spacing[axis])), 3, last - 3);
  for (Image& image : phantom.study.gates)
    image = upper ? cropped(image, axis, 0, slice) : cropped(image, axis, slice, last);
}

Vec3 axis_of(const synthetic::Phantom& phantom) {
  const TriMesh& epi = phantom.truth.front().epi;
  return (epi.vertices.back() - epi.vertices.front()).normalized();
}

void scale_spacing(Study& study, const Vec3& by) {
  for (Image& image : study.gates) {
    const Grid old = image.grid;
    const Index3 middle{old.dims[0] / 2, old.dims[1] / 2, old.dims[2] / 2};
    image.grid.spacing = old.spacing.cwiseProduct(by);
    image.grid.origin += to_world(old, centre_of(old, middle)) - to_world(image.grid, centre_of(image.grid, middle));
  }
}

/// Half of the gates were taken after the patient had moved.
void move_half(synthetic::Phantom& phantom, double way_mm) {
  const Grid& grid = phantom.study.grid();
  const int steps = std::max(1, static_cast<int>(std::lround(way_mm / grid.spacing[0])));
  const std::size_t gates = phantom.study.gates.size();
  for (std::size_t g = gates / 4; g < gates / 4 + gates / 2; ++g) {
    const Image old = phantom.study.gates[g];
    Image& image = phantom.study.gates[g];
    for (int k = 0; k < grid.dims[2]; ++k)
      for (int j = 0; j < grid.dims[1]; ++j)
        for (int i = 0; i < grid.dims[0]; ++i) image(i, j, k) = old.clamped(i - steps, j, k);
    const Vec3 shift = steps * grid.spacing[0] * grid.direction.col(0);
    for (TriMesh* mesh : {&phantom.truth[g].endo, &phantom.truth[g].epi})
      for (Vec3& p : mesh->vertices) p += shift;
  }
}

/// Every third gate next: the order of a file that was sorted by name.
void shuffle(synthetic::Phantom& phantom) {
  const std::size_t n = phantom.study.gates.size();
  const synthetic::Phantom old = phantom;
  for (std::size_t g = 0; g < n; ++g)
    phantom.study.gates[g] = old.study.gates[3 * g % n], phantom.truth[g] = old.truth[3 * g % n];
}

void fill_all(synthetic::Phantom& phantom, const std::function<double(const Vec3&)>& activity, std::uint64_t seed) {
  for (std::size_t g = 0; g < phantom.study.gates.size(); ++g) {
    Image& image = phantom.study.gates[g];
    for (int k = 0; k < image.grid.dims[2]; ++k)
      for (int j = 0; j < image.grid.dims[1]; ++j)
        for (int i = 0; i < image.grid.dims[0]; ++i)
          image(i, j, k) = static_cast<float>(100 * activity(to_world(image.grid, centre_of(image.grid, {i, j, k}))));
    image = synthetic::blur(synthetic::draw_counts(synthetic::blur(image, 9), seed, g), 8);
  }
}

struct Kind {
  std::string_view name;
  std::function<Planted(int)> make;
};

Planted changed_patient(int n, const std::function<void(synthetic::VirtualPatient&)>& change) {
  Planted p{plain_patient(n), {}};
  change(p.patient.options);
  p.phantom = scan(p.patient);
  return p;
}

Planted changed_study(int n, const std::function<void(synthetic::Phantom&)>& change) {
  Planted p{plain_patient(n), {}};
  p.phantom = scan(p.patient);
  change(p.phantom);
  return p;
}

Planted no_heart(int n, const std::function<double(const Vec3&)>& activity) {
  Planted p = changed_study(n, [&](synthetic::Phantom& f) { fill_all(f, activity, static_cast<std::uint64_t>(n)); });
  p.is_heart = false;
  return p;
}

void look_at_trunk(synthetic::VirtualPatient& o, int number) {
  o.torso.present = true;
  o.cut = synthetic::Cut::transaxial;
  o.pose.tilt_deg = 0;
  const double voxel = dice(number, 1, 5, 7);
  o.lattice = {
      static_cast<int>(400 / voxel), static_cast<int>(400 / voxel), static_cast<int>(300 / voxel), voxel, voxel, voxel};
  o.pose.offset_x_mm = dice(number, 2, 20, 60), o.pose.offset_y_mm = dice(number, 3, -60, -20);
  o.pose.offset_z_mm = dice(number, 4, -40, 60);
  o.right_ventricle = dice(number, 5, 0.2, 0.45);
  o.torso.liver = dice(number, 6, 0.3, 0.9);
  o.torso.gallbladder = dice(number, 7, 0.5, 2);
  o.torso.lung = dice(number, 8, 0.05, 0.2);
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"cut_base", [](int n) { return changed_study(n, [](synthetic::Phantom& f) { cut(f, 2, 0.35, axis_of(f)); }); }},
      {"cut_apex", [](int n) { return changed_study(n, [](synthetic::Phantom& f) { cut(f, 2, 0.3, -axis_of(f)); }); }},
      {"cut_side",
       [](int n) {
         return changed_study(n, [](synthetic::Phantom& f) { cut(f, 0, 0.4, f.study.grid().direction.col(0)); });
       }},
      {"hot_gut_touches",
       [](int n) {
         return changed_patient(n, [n](synthetic::VirtualPatient& o) {
           o.gut_amplitude = dice(n, 1, 1.5, 3), o.gut_gap_mm = dice(n, 2, -5, 1), o.gut_radius_mm = 20;
           o.gut_position = dice(n, 3, 0.2, 0.7);
         });
       }},
      {"hot_gut_apex",
       [](int n) {
         return changed_patient(n, [n](synthetic::VirtualPatient& o) {
           o.gut_amplitude = dice(n, 1, 2, 4), o.gut_gap_mm = dice(n, 2, 0, 4), o.gut_radius_mm = 16;
           o.gut_position = dice(n, 3, -0.2, 0.1);
         });
       }},
      {"missing_gate",
       [](int n) {
         return changed_study(n, [n](synthetic::Phantom& f) {
           Image& gate = f.study.gates[static_cast<std::size_t>(n % 8)];
           std::fill(gate.values.begin(), gate.values.end(), 0.0F);
         });
       }},
      {"weak_gate",
       [](int n) {
         return changed_study(n, [n](synthetic::Phantom& f) {
           Image& gate = f.study.gates[static_cast<std::size_t>(n % 8)];
           for (float& v : gate.values) v *= 1.0F / 3;
           gate = synthetic::blur(synthetic::draw_counts(gate, 5, 0), 4);
         });
       }},
      {"shuffled_gates", [](int n) { return changed_study(n, shuffle); }},
      {"same_gates",
       [](int n) {
         return changed_study(n, [](synthetic::Phantom& f) {
           const Image mean = heart::mean_image(f.study.gates);
           for (Image& gate : f.study.gates) gate = mean;
         });
       }},
      {"extreme_noise",
       [](int n) {
         return changed_patient(n, [n](synthetic::VirtualPatient& o) {
           o.noise.peak_counts = dice(n, 1, 0.5, 4), o.noise.filter_fwhm_mm = dice(n, 2, 3, 6);
         });
       }},
      {"no_heart_noise", [](int n) { return no_heart(n, [](const Vec3&) { return 0.5; }); }},
      {"no_heart_ball",
       [](int n) { return no_heart(n, [](const Vec3& p) { return (p - Vec3(45, -35, 10)).norm() < 40 ? 1 : 0.05; }); }},
      {"no_heart_abdomen",
       [](int n) {
         Planted p{plain_patient(n), {}};
         look_at_trunk(p.patient.options, n);
         p.patient.options.pose.offset_z_mm = 280;
         p.phantom = scan(p.patient);
         p.is_heart = false;
         return p;
       }},
      {"pixels_too_large",
       [](int n) { return changed_study(n, [](synthetic::Phantom& f) {
                     scale_spacing(f.study, {1.6, 1.6, 1.6});
                   }); }},
      {"pixels_too_small",
       [](int n) { return changed_study(n, [](synthetic::Phantom& f) {
                     scale_spacing(f.study, {0.6, 0.6, 0.6});
                   }); }},
      {"slices_too_thick",
       [](int n) { return changed_study(n, [](synthetic::Phantom& f) {
                     scale_spacing(f.study, {1, 1, 1.8});
                   }); }},
      {"slices_too_thin",
       [](int n) { return changed_study(n, [](synthetic::Phantom& f) {
                     scale_spacing(f.study, {1, 1, 0.55});
                   }); }},
      {"cavity_blurred_away",
       [](int n) {
         return changed_patient(n, [n](synthetic::VirtualPatient& o) {
           o.edv_ml = dice(n, 1, 28, 42), o.wall_ml = 70 + 0.35 * o.edv_ml;
           o.ef_percent = dice(n, 2, 60, 78), o.base_excursion_mm = 0.16 * o.ef_percent;
           o.fwhm_mm = dice(n, 3, 14, 16);
         });
       }},
      {"bright_right_ventricle",
       [](int n) {
         return changed_patient(n, [n](synthetic::VirtualPatient& o) { o.right_ventricle = dice(n, 1, 1.1, 1.8); });
       }},
      {"no_apex",
       [](int n) {
         return changed_patient(n, [n](synthetic::VirtualPatient& o) {
           o.defect = synthetic::Defect::apical, o.defect_extent_deg = dice(n, 1, 130, 180), o.defect_severity = 1;
         });
       }},
      {"half_the_wall",
       [](int n) {
         return changed_patient(n, [n](synthetic::VirtualPatient& o) {
           o.defect = n % 2 ? synthetic::Defect::lateral : synthetic::Defect::inferior, o.defect_extent_deg = 200,
           o.defect_severity = 1;
         });
       }},
      {"patient_moves",
       [](int n) { return changed_study(n, [n](synthetic::Phantom& f) { move_half(f, dice(n, 1, 10, 20)); }); }},
      {"upside_down",
       [](int n) {
         return changed_study(n, [](synthetic::Phantom& f) {
           const bool along = f.study.grid().direction.col(2).dot(axis_of(f)) > 0;
           f.study.slice_order = along ? SliceOrder::base_to_apex : SliceOrder::apex_to_base;
         });
       }},
  };
  return all;
}

}  // namespace

std::span<const std::string_view> failure_kinds() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const Kind& kind : kinds()) all.push_back(kind.name);
    return all;
  }();
  return names;
}

Planted plant(std::string_view kind, int number) {
  const auto found = std::find_if(kinds().begin(), kinds().end(), [&](const Kind& k) { return k.name == kind; });
  return found->make(number);
}

std::span<const std::string_view> field_kinds() {
  static constexpr std::array<std::string_view, 5> names{"chest", "hot_liver", "whole_body", "hot_gallbladder",
                                                         "busy_lung"};
  return names;
}

Planted place_in_field(std::string_view kind, int number) {
  Planted p{plain_patient(number), {}};
  synthetic::VirtualPatient& o = p.patient.options;
  o.fwhm_mm = std::min(o.fwhm_mm, 14.0);
  look_at_trunk(o, number);
  if (kind == "hot_liver") o.torso.liver = dice(number, 9, 1, 1.5);
  if (kind == "hot_gallbladder") o.torso.gallbladder = dice(number, 9, 3, 8);
  if (kind == "busy_lung") o.torso.lung = dice(number, 9, 0.25, 0.4);
  if (kind == "whole_body") {
    o.lattice.nz = static_cast<int>(750 / o.lattice.dz_mm);
    o.pose.offset_z_mm = 230;
  }
  p.phantom = scan(p.patient);
  return p;
}

}  // namespace dynasurf
