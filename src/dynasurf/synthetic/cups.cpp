#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/synthetic/detail/assembly.hpp"
#include "dynasurf/synthetic/detail/solids.hpp"

// The phantoms made of "cylinder on half sphere" walls.

namespace dynasurf::synthetic {
namespace {

constexpr Index3 sub_samples{5, 5, 5};

struct Cups {
  CylinderCup inner, outer;
};

Cups cups_of(const CupShape& s, const std::string& path) {
  if (s.inner_radius_mm >= s.outer_radius_mm) {
    TextOutput text;
    text << "option " << path << ".inner_radius_mm is " << s.inner_radius_mm
         << "; expected a number < outer_radius_mm (" << s.outer_radius_mm << ")";
    throw OptionError(text.str());
  }
  return {{s.inner_radius_mm, s.height_mm}, {s.outer_radius_mm, s.height_mm}};
}

Box box_of(const CylinderCup& cup) {
  return {{-cup.radius_mm, -cup.radius_mm, -cup.radius_mm}, {cup.radius_mm, cup.radius_mm, cup.height_mm}};
}

Vec3 middle_of(const CylinderCup& outer) { return {0, 0, (outer.height_mm - outer.radius_mm) / 2}; }

/// Part of a cup's volume below a height, mm3.
double volume_below(const CylinderCup& cup, double z) {
  const double r = cup.radius_mm;
  if (z <= -r) return 0;
  // A cap of the half sphere below 0, the cylinder above.
  if (z <= 0) return M_PI * (z + r) * (z + r) * (2 * r - z) / 3;
  return M_PI * r * r * (2.0 / 3.0 * r + std::min(z, cup.height_mm));
}
double wall_below(const Cups& cups, double z) { return volume_below(cups.outer, z) - volume_below(cups.inner, z); }
double whole_wall(const Cups& cups) { return wall_below(cups, cups.outer.height_mm); }

/// A wall whose activity is given point by point, an even cavity, nothing around.
Scene wall_scene(const Cups& cups, Density wall, double cavity = 0) {
  return {[cups, wall = std::move(wall), cavity](const Vec3& p) {
            if (!cups.outer.contains(p)) return 0.0;
            return cups.inner.contains(p) ? cavity : wall(p);
          },
          box_of(cups.outer)};
}

TrueGate truth_of(const Grid& grid, const Frame& frame, const Cups& cups) {
  TrueGate truth;
  truth.endo = place_in_world(grid, frame, surface(cups.inner));
  truth.epi = place_in_world(grid, frame, surface(cups.outer));
  truth.endo_ml = volume_ml(cups.inner);
  truth.epi_ml = volume_ml(cups.outer);
  return truth;
}

/// What the phantoms of one instant share.
struct Setting {
  double sigma_mm;
  Pose pose;
  Lattice lattice;
  Noise noise;
};

Phantom take(std::string_view kind, const Cups& cups, const Scene& scene, const Setting& s) {
  Phantom phantom;
  phantom.kind = kind;
  phantom.fwhm_mm = fwhm_of_sigma(s.sigma_mm);
  const Noise noise = limit_filter(s.noise, phantom.fwhm_mm, phantom.notes);
  const Grid grid = make_grid(s.lattice);
  const Frame frame = make_frame(grid, s.pose, middle_of(cups.outer));
  phantom.truth.push_back(truth_of(grid, frame, cups));
  const Image activity = render_scene(grid, frame, scene, fwhm_before_filter(phantom.fwhm_mm, noise), sub_samples);
  phantom.study = make_study(expose({activity}, noise), 0);
  return phantom;
}

Image make_binary(Image image, double level) {
  const double hottest = *std::max_element(image.values.begin(), image.values.end());
  // Nothing is set in an empty image.
  return image::threshold_at(std::move(image), std::max(level * hottest, std::numeric_limits<double>::min()));
}

/// Doubling and thresholding, as `o` asks for them.
void finish_values(Phantom& phantom, const Hebron& o) {
  for (Image& image : phantom.study.gates) {
    if (o.doubled) image = image::double_resolution(image);
    if (o.values == Values::binary) image = make_binary(std::move(image), o.binary_level);
  }
}

Scene with_cover(const Scene& scene, const Hebron& o) {
  if (!o.cover) return scene;
  const double low = o.shape.height_mm, high = low + o.lattice.dz_mm, radius = o.cover_radius_mm;
  return {[=](const Vec3& p) {
            if (p[2] > low && p[2] <= high && own::hypot(p[0], p[1]) <= radius) return 1.0;
            return scene.activity(p);
          },
          hull(scene.support, {{-radius, -radius, low}, {radius, radius, high}})};
}

Phantom take_hebron(std::string_view kind, const Hebron& o, const Cups& cups, const Scene& scene) {
  Phantom phantom = take(kind, cups, with_cover(scene, o), {o.sigma_mm, o.pose, o.lattice, o.noise});
  finish_values(phantom, o);
  return phantom;
}

CupShape mayo_shape(const Mayo& o) {
  const CupShape hebron;
  const double scale =
      own::cbrt(o.volume_mm3 / (1000 * volume_ml(CylinderCup{hebron.outer_radius_mm, hebron.height_mm})));
  return {scale * hebron.inner_radius_mm, scale * hebron.outer_radius_mm, scale * hebron.height_mm};
}

/// Height below which the wall has the given volume.
double height_of_wall_volume(const Cups& cups, double volume_mm3) {
  double low = -cups.outer.radius_mm, high = cups.outer.height_mm;
  // By halving: a hundred steps reach the last bit.
  for (int n = 0; n < 100; ++n) {
    const double middle = (low + high) / 2;
    (wall_below(cups, middle) < volume_mm3 ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// True where the wall of a partly filled phantom is empty.
std::function<bool(const Vec3&)> emptied(const Partial& o, const Cups& cups) {
  const double gone = o.fraction * whole_wall(cups);
  if (o.missing == Missing::apex) {
    const double cut = height_of_wall_volume(cups, gone);
    return [cut](const Vec3& p) { return p[2] < cut; };
  }
  const bool patch = o.missing == Missing::patch;
  const double height = cups.outer.height_mm;
  const double low = patch ? height / 4 : -cups.outer.radius_mm, high = patch ? 3 * height / 4 : height;
  const double band = wall_below(cups, high) - wall_below(cups, low);
  if (gone > band) {
    TextOutput text;
    text << "option partial.fraction is " << o.fraction << "; expected a number <= " << band / whole_wall(cups)
         << " for a patch, which reaches over the middle half of the cylinder only";
    throw OptionError(text.str());
  }
  const double width = 360 * gone / band / o.pieces;
  return [=, pieces = o.pieces, first = o.towards_deg](const Vec3& p) {
    if (p[2] < low || p[2] > high) return false;
    for (int n = 0; n < pieces; ++n)
      if (in_sector(p, first + 360.0 * n / pieces, width)) return true;
    return false;
  };
}

bool is_sick(const Pathology& o, const Cups& cups, const Vec3& p) {
  const bool apex = p[2] < -0.5 * cups.outer.radius_mm;
  switch (o.disease) {
    case Disease::inferior:
      return in_sector(p, 90, o.extent_deg);
    case Disease::lateral:
      return in_sector(p, 0, o.extent_deg);
    case Disease::apical:
      return apex;
    case Disease::anteroapical:
      return apex || in_sector(p, 270, o.extent_deg);
    case Disease::muga:
      return true;
    case Disease::digestive:
    case Disease::right_ventricle:
      return false;
  }
  return false;
}

/// Adds activity where the left ventricle is not.
Scene with_neighbour(const Scene& scene, const CylinderCup& outer, const Density& neighbour, const Box& box) {
  return {[=](const Vec3& p) { return outer.contains(p) ? scene.activity(p) : neighbour(p); },
          hull(scene.support, box)};
}

Scene with_digestive_blob(const Scene& scene, const CylinderCup& outer, double amplitude) {
  constexpr double sigma = 10, reach = 4 * sigma;
  const Vec3 centre = Vec3(0, 0.5, -std::sqrt(0.75)) * (outer.radius_mm + sigma);
  const auto blob = [=](const Vec3& p) {
    return amplitude * own::exp(-(p - centre).squaredNorm() / (2 * sigma * sigma));
  };
  return with_neighbour(scene, outer, blob, {centre - Vec3::Constant(reach), centre + Vec3::Constant(reach)});
}

Scene with_right_ventricle(const Scene& scene, const CylinderCup& outer, double amplitude) {
  const RightVentricle right = right_ventricle_beside(outer.radius_mm, -0.7 * outer.radius_mm, outer.height_mm);
  return with_neighbour(
      scene, outer, [=](const Vec3& p) { return right.in_wall(p) ? amplitude : 0.0; }, box_of(right));
}

/// A cavity of Hebron's proportions and an outer cup of the same height, with the given volumes.
Cups cups_of_volumes(double cavity_mm3, double wall_mm3) {
  const CupShape hebron;
  const double scale =
      own::cbrt(cavity_mm3 / (1000 * volume_ml(CylinderCup{hebron.inner_radius_mm, hebron.height_mm})));
  Cups cups;
  cups.inner = {scale * hebron.inner_radius_mm, scale * hebron.height_mm};
  double low = cups.inner.radius_mm, high = 10 * low + own::cbrt(wall_mm3);
  for (int n = 0; n < 200; ++n) {
    const double middle = (low + high) / 2;
    (1000 * volume_ml(CylinderCup{middle, cups.inner.height_mm}) < cavity_mm3 + wall_mm3 ? low : high) = middle;
  }
  cups.outer = {(low + high) / 2, cups.inner.height_mm};
  return cups;
}

}  // namespace

Phantom make_phantom(const Hebron& options) {
  Hebron o = options;
  check_options(o, std::string(Hebron::name));
  const Cups cups = cups_of(o.shape, "hebron.shape");
  Phantom phantom = take_hebron(Hebron::name, o, cups, wall_scene(cups, [](const Vec3&) { return 1.0; }));
  phantom.options = o;
  return phantom;
}

Phantom make_phantom(const Mayo& options) {
  Mayo o = options;
  check_options(o, std::string(Mayo::name));
  const Cups cups = cups_of(mayo_shape(o), "mayo");
  Phantom phantom = take(Mayo::name, cups, wall_scene(cups, [](const Vec3&) { return 1.0; }),
                         {o.sigma_mm, o.pose, o.lattice, o.noise});
  phantom.options = o;
  return phantom;
}

Phantom make_phantom(const Partial& options) {
  Partial o = options;
  check_options(o, std::string(Partial::name));
  const Cups cups = cups_of(mayo_shape(o.base), "partial.base");
  const auto empty = emptied(o, cups);
  Phantom phantom = take(Partial::name, cups, wall_scene(cups, [=](const Vec3& p) { return empty(p) ? 0.0 : 1.0; }),
                         {o.base.sigma_mm, o.base.pose, o.base.lattice, o.base.noise});
  phantom.missing_fraction = o.fraction;
  phantom.options = o;
  return phantom;
}

Phantom make_phantom(const Gap& options) {
  Gap o = options;
  check_options(o, std::string(Gap::name));
  const Cups cups = cups_of(o.base.shape, "gap.base.shape");
  const double middle = middle_of(cups.outer)[2];
  const double half = o.part * (cups.outer.height_mm + cups.outer.radius_mm) / 2;
  const auto wall = [=](const Vec3& p) { return std::abs(p[2] - middle) < half ? 0.0 : 1.0; };
  Phantom phantom = take_hebron(Gap::name, o.base, cups, wall_scene(cups, wall));
  phantom.missing_fraction = (wall_below(cups, middle + half) - wall_below(cups, middle - half)) / whole_wall(cups);
  phantom.options = o;
  return phantom;
}

Phantom make_phantom(const Pathology& options) {
  Pathology o = options;
  check_options(o, std::string(Pathology::name));
  const Cups cups = cups_of(o.base.shape, "pathology.base.shape");
  const double cavity = o.disease == Disease::muga ? 1 : 0;
  Scene scene = wall_scene(
      cups, [=](const Vec3& p) { return is_sick(o, cups, p) ? o.uptake : 1.0; }, cavity);
  if (o.disease == Disease::digestive) scene = with_digestive_blob(scene, cups.outer, o.amplitude);
  if (o.disease == Disease::right_ventricle) scene = with_right_ventricle(scene, cups.outer, o.amplitude);
  Phantom phantom = take_hebron(Pathology::name, o.base, cups, scene);
  phantom.options = o;
  return phantom;
}

Phantom make_phantom(const CardiacCycle& options) {
  CardiacCycle o = options;
  check_options(o, std::string(CardiacCycle::name));
  // Thesis table 6.16, mm3.
  static constexpr std::array<double, 8> cavities{74741, 45677, 36523, 32956, 47237, 55825, 63133, 79581};
  static constexpr std::array<double, 8> walls{369021, 271127, 217589, 217175, 252542, 290005, 388392, 394027};

  Phantom phantom;
  phantom.kind = CardiacCycle::name;
  phantom.fwhm_mm = fwhm_of_sigma(o.sigma_mm);
  const Noise noise = limit_filter(o.noise, phantom.fwhm_mm, phantom.notes);
  const Grid grid = make_grid(o.lattice);
  std::vector<Cups> cups;
  for (std::size_t g = 0; g < cavities.size(); ++g)
    cups.push_back(cups_of_volumes(cavities[g], o.wall == WallVolume::constant ? 1000 * o.wall_ml : walls[g]));
  // The plane between half sphere and cylinder stays where the largest instant has it.
  const Frame frame = make_frame(grid, o.pose, middle_of(cups.back().outer));
  std::vector<Image> images(cups.size());
  phantom.truth.resize(cups.size());
  parallel_for(cups.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      phantom.truth[g] = truth_of(grid, frame, cups[g]);
      phantom.truth[g].phase = (g + 0.5) / cups.size();
      images[g] = render_scene(grid, frame, wall_scene(cups[g], [](const Vec3&) { return 1.0; }),
                               fwhm_before_filter(phantom.fwhm_mm, noise), sub_samples);
    }
  });
  phantom.study = make_study(expose(std::move(images), noise), 60000 / o.heart_rate_bpm);
  phantom.options = o;
  summarise(phantom);
  return phantom;
}

}  // namespace dynasurf::synthetic
