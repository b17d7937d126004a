#include "dynasurf/psf_fit/detail/attenuation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynasurf/core/detail/degrees.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/fourier.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::psf_fit {
namespace {

constexpr double unit_mm = 50;                  // of place
constexpr double room_mm = 60, fading_mm = 30;  // around the pixels of the fit, and in which values fade out there
using Linear = std::array<double, 4>;           // coefficients of 1, left, back, head

// Means over patients 1 to 8 of experiments/camera, both reconstructions, without noise.
constexpr Linear usual_plain{0, 0.385, -0.256, 0.026}, usual_cosine{0.156, -0.200, -0.332, -0.186},
    usual_sine{0.201, 0.100, -0.465, -0.100};

/// The usual attenuation, then each coefficient alone: three of the plain part, four each of the others.
constexpr std::size_t terms = 12;

/// The fit's pixels and some more around them, as far as the study reaches, within a box whose sides are powers of 2.
struct Surroundings {
  Pixels pixels;
  Index3 before{0, 0, 0}, own_count{0, 0, 0};  // pixels added before the fit's own, and those
  Index3 size{1, 1, 1};
  std::array<FourierTable, 3> tables;
  std::vector<Vec3> place;           // patient's axes, from the heart's centre, over the unit
  std::vector<float> fade;           // from 1 at the fit's pixels to 0 at the rim
  std::vector<double> cosine, sine;  // of twice the direction of a transverse frequency, over the number of values

  std::size_t values() const { return size_of(size); }
  /// at(place among the pixels, place in the box) for every pixel.
  template <class F>
  void for_all(const F& at) const {
    std::size_t n = 0;
    for (int k = 0; k < pixels.count[2]; ++k)
      for (int j = 0; j < pixels.count[1]; ++j) {
        const std::size_t row = index_in(size, {0, j, k});
        for (int i = 0; i < pixels.count[0]; ++i, ++n) at(n, row + i);
      }
  }
  /// The same for the fit's own pixels, in their order.
  template <class F>
  void for_own(const F& at) const {
    for (int k = 0; k < own_count[2]; ++k)
      for (int j = 0; j < own_count[1]; ++j)
        for (int i = 0; i < own_count[0]; ++i) {
          const Index3 pixel{i + before[0], j + before[1], k + before[2]};
          at(index_in(pixels.count, pixel), index_in(size, pixel));
        }
  }
};

Surroundings surroundings_of(const Grid& grid, const Pixels& pixels, const HeartFrame& frame) {
  Surroundings s;
  s.pixels = pixels;
  s.own_count = pixels.count;
  std::array<std::vector<double>, 3> fade;
  for (int a = 0; a < 3; ++a) {
    const int joined = pixels.joined[a], inside = pixels.count[a];
    const double pitch = joined * pixels.spacing[a];
    const int room = ceil_int(room_mm / pitch);
    s.before[a] = std::min(room, pixels.first[a] / joined);
    const int after = std::min(room, (grid.dims[a] - pixels.first[a]) / joined - inside);
    s.pixels.first[a] -= s.before[a] * joined;
    s.pixels.count[a] = s.before[a] + inside + after;
    s.size[a] = power_of_two(s.pixels.count[a]);
    s.tables[a] = make_fourier_table(s.size[a]);
    for (int n = 0; n < s.pixels.count[a]; ++n) {
      const int outside = std::max({0, s.before[a] - n, n - s.before[a] - inside + 1});
      fade[a].push_back(
          0.5 + 0.5 * own::cos(M_PI * std::clamp((outside * pitch - room_mm + fading_mm) / fading_mm, 0.0, 1.0)));
    }
  }
  const Mat3 turn = to_patient(grid, frame);
  for (int k = 0; k < s.pixels.count[2]; ++k)
    for (int j = 0; j < s.pixels.count[1]; ++j)
      for (int i = 0; i < s.pixels.count[0]; ++i) {
        const Vec3 centre(s.pixels.centre(0, i), s.pixels.centre(1, j), s.pixels.centre(2, k));
        s.place.push_back(turn * (centre - frame.centre) / unit_mm);
        s.fade.push_back(fade[0][i] * fade[1][j] * fade[2][k]);
      }
  const auto frequency = [&](int a, int k) {
    return (2 * k < s.size[a] ? k : k - s.size[a]) / (s.size[a] * pixels.joined[a] * pixels.spacing[a]);
  };
  const double share = 1.0 / s.values();
  s.cosine.resize(s.values()), s.sine.resize(s.values());
  parallel_for(s.size[2], 1, [&](int begin, int end) {
    for (int k = begin; k < end; ++k)
      for (int j = 0; j < s.size[1]; ++j)
        for (int i = 0; i < s.size[0]; ++i) {
          const Vec3 f = turn * Vec3(frequency(0, i), frequency(1, j), frequency(2, k));
          const double square = f[0] * f[0] + f[1] * f[1];
          const double scale = square > 1e-12 ? share / square : 0;
          const std::size_t at = index_in(s.size, {i, j, k});
          s.cosine[at] = scale * (f[0] * f[0] - f[1] * f[1]);
          s.sine[at] = scale * 2 * f[0] * f[1];
        }
  });
  return s;
}

/// The images of two gates as one of complex numbers, faded out at the rim.
std::vector<Complex> images_of(const Surroundings& s, const std::vector<float>& one, const std::vector<float>& other) {
  std::vector<Complex> values(s.fade.size());
  for (std::size_t n = 0; n < values.size(); ++n) {
    const double fade = s.fade[n];
    values[n] = {fade * one[n], fade * other[n]};
  }
  return values;
}

/// What a coefficient of a linear function of the place counts by: 1, left, back, head.
double coordinate(const Vec3& place, std::size_t part) { return part == 0 ? 1 : place[part - 1]; }

/// The spectrum of the images times a coordinate of the place.
void find_spectrum(const Surroundings& s, const std::vector<Complex>& images, std::size_t part,
                   std::vector<Complex>& spectrum) {
  spectrum.assign(s.values(), Complex{});
  s.for_all([&](std::size_t n, std::size_t at) {
    const double w = coordinate(s.place[n], part);
    spectrum[at] = {w * images[n].re, w * images[n].im};
  });
  transform_box(s.tables, spectrum, -1);
}

/// A filtered image of two gates, right at the fit's own pixels alone.
void filter(const Surroundings& s, const std::vector<double>& response, const std::vector<Complex>& spectrum,
            std::vector<Complex>& box) {
  box.resize(spectrum.size());
  for (std::size_t n = 0; n < box.size(); ++n) box[n] = {response[n] * spectrum[n].re, response[n] * spectrum[n].im};
  transform_box(s.tables, box, 1, {s.before, s.own_count});
}

}  // namespace

Mat3 to_patient(const Grid& grid, const HeartFrame& frame) {
  constexpr double along_the_body = 0.87;
  const Vec3 axis = grid.direction * frame.axes.col(2);
  if (std::abs(axis[2]) < along_the_body) return grid.direction;
  constexpr double left = 45 * degrees, down = 30 * degrees;
  const Vec3 usual(-own::cos(down) * own::sin(left), own::cos(down) * own::cos(left), own::sin(down));
  const Vec3 lateral = Vec3(usual[1], -usual[0], 0).normalized();
  Mat3 of_heart;
  of_heart << lateral, usual.cross(lateral), usual;
  return of_heart * frame.axes.transpose();
}

std::vector<std::vector<std::vector<float>>> attenuation_images(const Study& study, const Pixels& pixels,
                                                                const HeartFrame& frame, double unit,
                                                                const std::vector<std::vector<float>>& model,
                                                                const std::vector<float>& weight) {
  const Surroundings s = surroundings_of(study.grid(), pixels, frame);
  const std::size_t gates = study.gates.size();
  const auto image_of = [&](std::size_t g) {
    std::vector<float> values = join(study.gates[g], s.pixels);
    for (float& v : values) v = std::isfinite(v) ? v / unit : 0;
    std::size_t own = 0;
    s.for_own([&](std::size_t at, std::size_t) {
      if (weight[own] > 0) values[at] = model[g][own];
      ++own;
    });
    return values;
  };
  std::vector<std::vector<std::vector<float>>> images(
      terms, std::vector<std::vector<float>>(gates, std::vector<float>(pixels.size())));
  parallel_for((gates + 1) / 2, 1, [&](std::size_t pair, std::size_t) {
    const std::size_t first = 2 * pair, second = std::min(first + 1, gates - 1);
    const std::vector<Complex> both = images_of(s, image_of(first), image_of(second));
    std::vector<Complex> usual(pixels.size());
    const auto put = [&](std::size_t term, std::size_t own, const Complex& value) {
      images[term][first][own] = value.re;
      if (second != first) images[term][second][own] = value.im;
    };
    std::size_t term = 0;
    /// at(own, place among the pixels, place in the box) is what a coefficient of 1 adds.
    const auto add_term = [&](double usual_coefficient, const auto& at) {
      ++term;
      std::size_t own = 0;
      s.for_own([&](std::size_t pixel, std::size_t in_box) {
        const Complex added = at(own, pixel, in_box);
        put(term, own, added);
        usual[own].re += usual_coefficient * added.re, usual[own].im += usual_coefficient * added.im;
        ++own;
      });
    };
    for (std::size_t part = 1; part < usual_plain.size(); ++part)
      add_term(usual_plain[part], [&](std::size_t, std::size_t pixel, std::size_t) {
        const double w = coordinate(s.place[pixel], part);
        return Complex{w * both[pixel].re, w * both[pixel].im};
      });
    // One spectrum at a time serves both filters; of the sine's only the fit's own pixels wait for their turn.
    std::vector<Complex> spectrum, box;
    std::array<std::vector<Complex>, usual_sine.size()> of_sine;
    for (std::size_t part = 0; part < usual_cosine.size(); ++part) {
      find_spectrum(s, both, part, spectrum);
      filter(s, s.sine, spectrum, box);
      s.for_own([&](std::size_t, std::size_t in_box) { of_sine[part].push_back(box[in_box]); });
      filter(s, s.cosine, spectrum, box);
      add_term(usual_cosine[part], [&](std::size_t, std::size_t, std::size_t in_box) { return box[in_box]; });
    }
    for (std::size_t part = 0; part < usual_sine.size(); ++part)
      add_term(usual_sine[part], [&](std::size_t own, std::size_t, std::size_t) { return of_sine[part][own]; });
    for (std::size_t own = 0; own < usual.size(); ++own) put(0, own, usual[own]);
  });
  return images;
}

}  // namespace dynasurf::psf_fit
