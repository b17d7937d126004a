#include "dynasurf/psf_fit/gaussian_profile.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/psf_fit/detail/harmonics.hpp"
#include "dynasurf/psf_fit/detail/start.hpp"

namespace dynasurf::psf_fit {
namespace {

constexpr int ray_count = 600, degree = 6;
constexpr double share_of_deviation = 0.65;

struct Ray {
  Vec3 direction;       // unit, of the scaled frame
  Vec3 per_mm;          // grid frame, one mm along the ray
  double mm_per_q = 1;  // length of a unit of q
  Eigen::VectorXd harmonics;
};

/// Middle of the wall along each ray and the two deviations of the profile, mm, smooth over the directions.
struct WallProfiles {
  Eigen::VectorXd middle, inner, outer;
};

double sample(const Image& image, const Vec3& p) {
  const Grid& g = image.grid;
  const Vec3 v = p.cwiseQuotient(g.spacing);
  const int i = floor_int(v[0]), j = floor_int(v[1]), k = floor_int(v[2]);
  const Vec3 f = v - Vec3(i, j, k);
  double sum = 0;
  for (int c = 0; c < 2; ++c)
    for (int b = 0; b < 2; ++b)
      for (int a = 0; a < 2; ++a)
        sum +=
            (a ? f[0] : 1 - f[0]) * (b ? f[1] : 1 - f[1]) * (c ? f[2] : 1 - f[2]) * image.clamped(i + a, j + b, k + c);
  return sum;
}

/// Standard deviation of the Gaussian that has the values of one side of a peak, down to half of it.
double deviation(const std::vector<double>& values, Index peak, int step, double step_mm) {
  double d4 = 0, d2 = 0;
  for (int n = 1;; ++n) {
    const Index at = peak + n * step;
    if (at < 0 || at >= std::ssize(values)) break;
    const double share = values[at] / values[peak];
    if (share < 0.5 || share >= 1) break;
    const double d = n * step_mm;
    d4 += d * d * d * d;
    d2 += d * d * -2 * own::log(share);
  }
  return d2 > 0 ? std::sqrt(d4 / d2) : 0;
}

std::vector<Ray> make_rays(const HeartFrame& frame) {
  std::vector<Ray> rays;
  std::vector<double> harmonics(harmonics_up_to(degree));
  for (int n = 0; n < ray_count; ++n) {
    Ray ray;
    ray.direction = fibonacci_direction(n, ray_count);
    const Vec3 step = frame.axes * ray.direction.cwiseProduct(frame.scale);
    ray.mm_per_q = step.norm();
    ray.per_mm = step / ray.mm_per_q;
    real_spherical_harmonics(ray.direction, degree, harmonics);
    ray.harmonics = Eigen::Map<Eigen::VectorXd>(harmonics.data(), harmonics.size());
    rays.push_back(std::move(ray));
  }
  return rays;
}

/// Distance along a ray to the base plane, mm; infinite for rays that go away from it.
double to_base(const Ray& ray, const HeartFrame& frame, const heart::BasePlane& base) {
  const double rise = ray.per_mm.dot(base.normal), depth = -base.height(frame.centre);
  return rise > 1e-6 ? std::max(0.0, depth / rise) : std::numeric_limits<double>::infinity();
}

std::optional<WallProfiles> profiles_of(const Image& image, const std::vector<Ray>& rays, const PlacedStart& start,
                                        std::size_t gate) {
  constexpr double step_mm = 0.75;
  const Eigen::VectorXd endo = harmonics_of_surface(start.endo[gate], start.frame, start.base[gate], degree);
  const Eigen::VectorXd epi = harmonics_of_surface(start.epi[gate], start.frame, start.base[gate], degree);
  Eigen::MatrixXd rows(ray_count, harmonics_up_to(degree));
  Eigen::MatrixXd values(ray_count, 3);
  Eigen::Index used = 0;
  for (const Ray& ray : rays) {
    const double from = 0.6 * own::exp(ray.harmonics.dot(endo)) * ray.mm_per_q;
    const double to = 1.25 * own::exp(ray.harmonics.dot(epi)) * ray.mm_per_q;
    if (to > to_base(ray, start.frame, start.base[gate])) continue;
    std::vector<double> profile;
    for (double d = 0; d <= to + 10; d += step_mm)
      profile.push_back(sample(image, start.frame.centre + d * ray.per_mm));
    const Index lowest = from / step_mm, end = std::min<double>(to / step_mm, profile.size());
    const auto first = profile.begin() + lowest, last = profile.begin() + end;
    if (first >= last) continue;
    const std::size_t peak = std::max_element(first, last) - profile.begin();
    if (!(profile[peak] > 0)) continue;
    const double inner = deviation(profile, peak, -1, step_mm), outer = deviation(profile, peak, 1, step_mm);
    if (inner <= 0 || outer <= 0) continue;
    rows.row(used) = ray.harmonics;
    values.row(used++) << own::log(peak * step_mm / ray.mm_per_q), own::log(inner), own::log(outer);
  }
  if (used < ray_count / 5) return std::nullopt;
  WallProfiles p;
  const Eigen::MatrixXd seen = rows.topRows(used);
  p.middle = smooth_harmonics(seen, values.col(0).head(used), degree);
  p.inner = smooth_harmonics(seen, values.col(1).head(used), degree);
  p.outer = smooth_harmonics(seen, values.col(2).head(used), degree);
  return p;
}

/// Along one ray, mm: the base plane, the brightest point, and the two deviations there.
struct Crossing {
  double base, middle, inner, outer;
};
std::vector<Crossing> crossings_of(const WallProfiles& p, const std::vector<Ray>& rays, const PlacedStart& start,
                                   std::size_t gate) {
  std::vector<Crossing> crossings;
  crossings.reserve(rays.size());
  for (const Ray& ray : rays)
    crossings.push_back({to_base(ray, start.frame, start.base[gate]),
                         own::exp(ray.harmonics.dot(p.middle)) * ray.mm_per_q, own::exp(ray.harmonics.dot(p.inner)),
                         own::exp(ray.harmonics.dot(p.outer))});
  return crossings;
}

struct Volumes {
  double cavity = 0, epi = 0;  // mm3
};

Volumes volumes_of(const std::vector<Crossing>& crossings, const std::vector<Ray>& rays, const HeartFrame& frame,
                   double share) {
  const double solid_angle = 4 * M_PI / ray_count * frame.scale.prod() / 3;
  Volumes v;
  for (std::size_t n = 0; n < rays.size(); ++n) {
    const Crossing& at = crossings[n];
    const auto cubed = [&](double mm) {
      const double q = std::clamp(mm, 0.0, at.base) / rays[n].mm_per_q;
      return q * q * q;
    };
    v.cavity += solid_angle * cubed(at.middle - share * at.inner);
    v.epi += solid_angle * cubed(at.middle + share * at.outer);
  }
  return v;
}

}  // namespace

std::optional<GaussianProfile> read_gaussian_profile(const Study& study, const FitStart& fit_start) {
  const PlacedStart start = place_start(fit_start, study.grid());
  const std::vector<Ray> rays = make_rays(start.frame);
  const std::size_t gates = study.gates.size();
  std::vector<std::optional<WallProfiles>> profiles(gates);
  parallel_for(gates, 1,
               [&](std::size_t g, std::size_t) { profiles[g] = profiles_of(study.gates[g], rays, start, g); });
  if (!std::all_of(profiles.begin(), profiles.end(), [](const auto& p) { return p.has_value(); })) return std::nullopt;
  double muscle = 0;
  std::vector<std::vector<Crossing>> crossings;
  for (std::size_t g = 0; g < gates; ++g) {
    crossings.push_back(crossings_of(*profiles[g], rays, start, g));
    const Volumes v = volumes_of(crossings[g], rays, start.frame, share_of_deviation);
    muscle += (v.epi - v.cavity) / gates;
  }
  GaussianProfile reading{std::vector<double>(gates), std::vector<double>(gates)};
  parallel_for(gates, 1, [&](std::size_t g, std::size_t) {
    double low = 0.1, high = 2;
    for (int n = 0; n < 40; ++n) {
      const double middle = (low + high) / 2;
      const Volumes v = volumes_of(crossings[g], rays, start.frame, middle);
      (v.epi - v.cavity < muscle ? low : high) = middle;
    }
    const Volumes v = volumes_of(crossings[g], rays, start.frame, (low + high) / 2);
    reading.cavity_ml[g] = v.cavity / 1000;
    reading.wall_ml[g] = (v.epi - v.cavity) / 1000;
  });
  return reading;
}

}  // namespace dynasurf::psf_fit
