#include "dynasurf/image/edges/detail/compass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/image/detail/ridges.hpp"

// All masses and values are whole numbers, so that their sums are exact: the map of a turned image is the turned map,
// and half windows can be summed up wedge by wedge.

namespace dynasurf::image {
namespace {

constexpr int most_clusters = 10, most_wedges = 12;  // see `describe`
constexpr int usual_orientations = 12;
constexpr int most_orientations = 2 * most_wedges;  // over half a turn
constexpr int levels = 1 << 14;                     // values between the smallest and the largest
constexpr int bins = 64;                            // of a window's values, for splitting them into clusters
constexpr double least_spread = levels * 0.002;     // clusters narrower than this are not split
constexpr double window_mass = 1 << 22;             // about; exact in a float, and its square sums in 64 bits

/// A pixel's mass in one wedge of the window.
struct Share {
  int pixel, wedge;
  std::int32_t mass;
};

struct Window {
  int radius = 0;
  std::vector<std::pair<int, int>> pixels;  // offsets
  std::vector<std::int32_t> masses;         // of the pixels
  std::vector<Share> shares;
};

/// Area of the disc within the pixel (dx, dy) per wedge, in half sub-samples of 8 x 8. Turned into the first quadrant,
/// so that the four quarters are exact copies; a sample on the diagonal of a wedge border counts for both sides.
std::vector<int> wedge_areas(int dx, int dy, double radius, int wedges) {
  constexpr int fine = 8;
  std::vector<int> area(4 * wedges, 0);
  for (int b = 0; b < fine; ++b)
    for (int a = 0; a < fine; ++a) {
      int x = 2 * fine * dx + 2 * a + 1 - fine, y = 2 * fine * dy + 2 * b + 1 - fine;  // in 16ths of a pixel
      const double limit = 2 * fine * radius;
      if (x * x + y * y > limit * limit) continue;
      int quarter = 0;
      for (; !(x > 0 && y > 0); ++quarter) {  // a quarter turn back
        const int t = x;
        x = y, y = -t;
      }
      const double within = own::atan2(y, x) / (std::numbers::pi / 2) * wedges;
      const int first = quarter * wedges;
      const bool on_border = x == y && wedges % 2 == 0;
      const int wedge = on_border ? wedges / 2 : std::min<int>(wedges - 1, within);
      area[first + wedge] += 1;
      area[first + (on_border ? wedge - 1 : wedge)] += 1;
    }
  return area;
}

Window make_window(const Compass& o) {
  Window w;
  const double radius = 3 * o.sigma_px;
  w.radius = ceil_int(radius);
  const auto weight = [&](int dx, int dy) {
    const double r2 = dx * dx + dy * dy;
    return std::sqrt(r2) * own::exp(-r2 / (2 * o.sigma_px * o.sigma_px));
  };
  double sum = 0;
  for (int dy = -w.radius; dy <= w.radius; ++dy)
    for (int dx = -w.radius; dx <= w.radius; ++dx) sum += 128 * weight(dx, dy);
  for (int dy = -w.radius; dy <= w.radius; ++dy)
    for (int dx = -w.radius; dx <= w.radius; ++dx) {
      const std::int32_t unit = std::lround(window_mass * weight(dx, dy) / sum);
      const std::vector<int> areas = wedge_areas(dx, dy, radius, o.wedges);
      const int pixel = w.pixels.size();
      std::int32_t mass = 0;
      for (int n = 0; n < std::ssize(areas); ++n) {
        if (areas[n] == 0 || unit == 0) continue;
        w.shares.push_back({pixel, n, unit * areas[n]});
        mass += unit * areas[n];
      }
      if (mass == 0) continue;
      w.pixels.emplace_back(dx, dy);
      w.masses.push_back(mass);
    }
  return w;
}

/// The values of a window, reduced to a few.
struct Codebook {
  int count = 0;
  std::array<double, most_clusters> value{};  // growing, in levels
  std::array<std::uint8_t, bins> cluster_of_bin{};
};

/// Sums over the values in the bins below one bin.
struct Moments {
  std::int64_t mass = 0, first = 0, second = 0;
  Moments operator-(const Moments& o) const { return {mass - o.mass, first - o.first, second - o.second}; }
  /// Squared deviations from the mean.
  double deviation() const {
    if (mass == 0) return 0;
    return second - 1.0 * first * first / mass;
  }
  double mean() const { return 1.0 * first / mass; }
};

/// Splits the values at the mean of the cluster with the largest deviation until there are `most` or all are narrow.
Codebook split(const std::array<Moments, bins + 1>& below, int low, double bins_per_level, int most) {
  struct Cluster {
    int begin, end;
    Moments moments;
    double deviation;
  };
  const auto make = [&](int begin, int end) {
    const Moments m = below[end] - below[begin];
    return Cluster{begin, end, m, m.deviation()};
  };
  std::array<Cluster, most_clusters> clusters;
  clusters[0] = make(0, bins);
  int count = 1;
  while (count < most) {
    int worst = -1;
    for (int c = 0; c < count; ++c) {
      const Cluster& at = clusters[c];
      const bool wide = at.deviation > least_spread * least_spread * at.moments.mass;
      if (wide && (worst < 0 || at.deviation > clusters[worst].deviation)) worst = c;
    }
    if (worst < 0) break;
    const Cluster from = clusters[worst];
    const int mean_bin = (from.moments.mean() - low) * bins_per_level;
    const auto divides = [&](int at) {
      return at > from.begin && at < from.end && make(from.begin, at).moments.mass > 0 &&
             make(at, from.end).moments.mass > 0;
    };
    const int at = divides(mean_bin + 1) ? mean_bin + 1 : mean_bin;
    if (!divides(at)) {
      clusters[worst].deviation = 0;  // all in one bin
      continue;
    }
    const Cluster left = make(from.begin, at), right = make(at, from.end);
    for (int c = count; c > worst + 1; --c) clusters[c] = clusters[c - 1];
    clusters[worst] = left;
    clusters[worst + 1] = right;
    ++count;
  }
  Codebook book;
  book.count = count;
  for (int c = 0; c < count; ++c) {
    const Cluster& at = clusters[c];
    book.value[c] = at.moments.mean();
    std::fill(book.cluster_of_bin.begin() + at.begin, book.cluster_of_bin.begin() + at.end, c);
  }
  return book;
}

/// Adds to `work`, for each orientation, the price of what the sweep moves between clusters i and j of the two halves.
/// `a_i[0]` and `a_i[1]` hold the mass of half A below cluster i and up to it. What both halves have at the same height
/// of the cumulated masses moves: max(0, min(a1, b3) - max(a0, b2)), and the same the other way; here in absolute
/// values, which are exact for whole numbers and which compilers turn into vector instructions.
template <std::size_t lanes>
void move_between(const std::array<float, lanes>* a_i, const std::array<float, lanes>* a_j,
                  const std::array<float, lanes>* b_i, const std::array<float, lanes>* b_j, float quarter_price,
                  std::array<float, lanes>& work) {
  std::array<float, lanes> sum = work;  // nothing else can point to a copy: no check is needed before the loop
  const float *a0 = a_i[0].data(), *a1 = a_i[1].data(), *a2 = a_j[0].data(), *a3 = a_j[1].data();
  const float *b0 = b_i[0].data(), *b1 = b_i[1].data(), *b2 = b_j[0].data(), *b3 = b_j[1].data();
  for (std::size_t o = 0; o < lanes; ++o) {
    const float there = (a1[o] + b3[o] - a0[o] - b2[o]) - std::abs(a1[o] - b3[o]) - std::abs(a0[o] - b2[o]);
    const float back = (b1[o] + a3[o] - b0[o] - a2[o]) - std::abs(b1[o] - a3[o]) - std::abs(b0[o] - a2[o]);
    sum[o] += (there + std::abs(there) + back + std::abs(back)) * quarter_price;
  }
  work = sum;
}

/// What one pixel answers.
struct Needle {
  float strength = 0, x = 0, y = 0, abnormality = 0, uncertainty_deg = 0;
};

class Operator {
 public:
  explicit Operator(const Compass& o) : o_(o), window_(make_window(o)), distance_(levels + 1) {
    for (int d = 0; d <= levels; ++d) distance_[d] = -own::expm1(-d / (o.gamma * (levels - 1)));
    for (int n = 0; n < orientations(); ++n) {
      // In the first quadrant and turned from there, so that the four quarters are exact copies.
      const double angle = n % o.wedges * std::numbers::pi / (2 * o.wedges);
      const double c = own::cos(angle), s = own::sin(angle);
      along_.push_back(n < o.wedges ? std::array<double, 2>{c, s} : std::array<double, 2>{-s, c});
    }
  }

  int radius() const { return window_.radius; }

  /// Places of the window's pixels in a slice of `stride` columns, relative to its centre.
  std::vector<int> places(int stride) const {
    std::vector<int> places;
    for (const auto& [dx, dy] : window_.pixels) places.push_back(dy * stride + dx);
    return places;
  }

  /// `centre` points to a pixel of a slice with at least radius() pixels around it.
  Needle read(const std::uint16_t* centre, const std::vector<int>& places) const {
    int low = levels, high = -1;
    for (const int p : places) low = std::min<int>(low, centre[p]), high = std::max<int>(high, centre[p]);
    if (high - low < 1) return {};

    std::array<std::uint8_t, 2048> bin;  // a window of sigma 7 px has 1405 pixels
    std::array<Moments, bins + 1> below{};
    const std::uint32_t factor = (bins << 16) / (high - low + 1);
    for (std::size_t n = 0; n < places.size(); ++n) {
      const int v = centre[places[n]];
      bin[n] = ((v - low) * factor) >> 16;
      Moments& m = below[bin[n] + 1U];
      const std::int64_t mass = window_.masses[n];
      m.mass += mass, m.first += mass * v, m.second += mass * v * v;
    }
    for (std::size_t b = 1; b <= bins; ++b) {
      below[b].mass += below[b - 1].mass, below[b].first += below[b - 1].first, below[b].second += below[b - 1].second;
    }
    const Codebook book = split(below, low, factor / 65536.0, o_.clusters);
    if (book.count < 2) return {};

    std::array<std::uint8_t, 2048> cluster;
    for (std::size_t n = 0; n < places.size(); ++n) cluster[n] = book.cluster_of_bin[bin[n]];

    Wedges wedge;
    std::fill_n(wedge.begin(), 2 * orientations(), std::array<std::int32_t, most_clusters>{});
    for (const Share& s : window_.shares) wedge[s.wedge][cluster[s.pixel]] += s.mass;
    return orientations() == usual_orientations ? turn<usual_orientations>(book, wedge)
                                                : turn<most_orientations>(book, wedge);
  }

 private:
  using Wedges = std::array<std::array<std::int32_t, most_clusters>, 2 * most_orientations>;
  int orientations() const { return 2 * o_.wedges; }

  /// Turns the diameter, compares the halves, and finds the best orientation. Lanes beyond the orientations asked for
  /// stay empty; their number is fixed so that the loops over them become vector instructions.
  template <std::size_t lanes>
  Needle turn(const Codebook& book, const Wedges& wedge) const {
    const std::size_t turns = orientations(), count = book.count;
    std::array<std::int32_t, most_clusters> half{}, all{};
    for (std::size_t w = 0; w < 2 * turns; ++w)
      for (std::size_t c = 0; c < count; ++c) all[c] += wedge[w][c], half[c] += w < turns ? wedge[w][c] : 0;
    std::int32_t total = 0;
    for (const std::int32_t mass : half) total += mass;

    // Mass of half A (counter-clockwise of the diameter), and of half B, in the clusters below c.
    alignas(64) std::array<std::array<float, lanes>, most_clusters + 1> below_a, below_b;
    below_a[0] = below_b[0] = {};
    if (turns < lanes) below_a = below_b = {};
    for (std::size_t o = 0; o < turns; ++o) {
      std::int32_t a = 0, b = 0;
      for (std::size_t c = 0; c < count; ++c) {
        a += half[c], b += all[c] - half[c];
        below_a[c + 1][o] = a;
        below_b[c + 1][o] = b;
        half[c] += wedge[o + turns][c] - wedge[o][c];
      }
    }

    alignas(64) std::array<float, lanes> work{};
    for (std::size_t i = 0; i + 1 < count; ++i)
      for (std::size_t j = i + 1; j < count; ++j) {
        // NOLINTNEXTLINE(bugprone-incorrect-roundings): values ascend, and std::lround is a call.
        const std::size_t apart = book.value[j] - book.value[i] + 0.5;
        move_between(&below_a[i], &below_a[j], &below_b[i], &below_b[j], distance_[apart] / 4, work);
      }

    Peak peak = find_peak(work.data(), total);
    if (peak.needle.strength == 0) return {};
    double brighter = 0;
    for (std::size_t c = 0; c < count; ++c)
      brighter += ((below_a[c + 1][peak.orientation] - below_a[c][peak.orientation]) -
                   (below_b[c + 1][peak.orientation] - below_b[c][peak.orientation])) *
                  book.value[c];
    if (brighter < 0) peak.needle.x = -peak.needle.x, peak.needle.y = -peak.needle.y;
    return peak.needle;
  }

  struct Peak {
    std::size_t orientation = 0;
    Needle needle;  // points into half A
  };

  Peak find_peak(const float* work, float total) const {
    const int turns = orientations();
    float most = 0, least = work[0];
    for (int o = 0; o < turns; ++o) most = std::max(most, work[o]), least = std::min(least, work[o]);
    if (!(most > 0)) return {};
    const auto before = [&](int o) { return work[o == 0 ? turns - 1 : o - 1]; };
    const auto after = [&](int o) { return work[o == turns - 1 ? 0 : o + 1]; };
    int peak = -1, near = 0;  // the first of the largest, counted around the circle
    for (int o = 0; o < turns; ++o) {
      near += work[o] >= 0.98F * most;
      if (peak < 0 && work[o] == most && before(o) < most) peak = o;
    }
    if (peak < 0) peak = 0;  // all the same

    const float fall = before(peak) - after(peak), bend = before(peak) + after(peak) - 2 * most;
    const float t = bend < 0 ? fall / (2 * bend) : 0;
    const std::size_t place = peak;
    Peak p{place, {}};
    p.needle.strength = std::min(1.0F, (most - fall * t / 4) / total);
    p.needle.abnormality = least / total;
    p.needle.uncertainty_deg = 180.0 / turns * near;
    // Turn the diameter by t steps, then by a quarter turn.
    const double small = t * std::numbers::pi / turns, c = own::cos(small), s = own::sin(small);
    const auto& along = along_[peak];
    p.needle.x = -(along[0] * s + along[1] * c);
    p.needle.y = along[0] * c - along[1] * s;
    return p;
  }

  Compass o_;
  Window window_;
  std::vector<float> distance_;               // of two values, by their difference in levels
  std::vector<std::array<double, 2>> along_;  // direction of each diameter
};

/// A slice of levels with a replicated border.
struct Padded {
  int stride;
  std::vector<std::uint16_t> values;
};

Padded pad(const Slice& s, int radius, float low, float high) {
  Padded p{s.width + 2 * radius, {}};
  const double scale = (levels - 1) / (double{high} - low);
  for (int j = -radius; j < s.height + radius; ++j)
    for (int i = -radius; i < s.width + radius; ++i)
      p.values.push_back(std::lround((double{s.clamped(i, j)} - low) * scale));
  return p;
}

}  // namespace

double sweep_distance(std::span<const double> mass_a, std::span<const double> mass_b,
                      std::span<const double> distance) {
  double work = 0, total = 0, a = 0, b = 0;
  std::size_t i = 0, j = 0;
  const std::size_t count = mass_a.size();
  for (const double m : mass_a) total += m;
  if (count > 0) a = mass_a[0], b = mass_b[0];
  while (i < count && j < count) {
    const double m = std::min(a, b);
    work += m * distance[i * count + j];
    a -= m, b -= m;
    if (a <= 0 && ++i < count) a = mass_a[i];
    if (b <= 0 && ++j < count) b = mass_b[j];
  }
  return work / total;
}

CompassMaps compass_maps(const Image& image, const Compass& options) {
  Compass o = options;
  check_options(o, "compass");
  const Image zero(image.grid);
  CompassMaps maps{zero, zero, zero, zero, zero};
  if (image.values.empty()) return maps;
  const auto [low, high] = std::minmax_element(image.values.begin(), image.values.end());
  if (!(*low < *high)) return maps;

  const Operator compass(o);
  for_each_slice(image.grid, [&, low = *low, high = *high](int k) {
    const int radius = compass.radius();
    const Padded padded = pad(slice_of(image, k), radius, low, high);
    const std::vector<int> places = compass.places(padded.stride);
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = 0; i < image.grid.dims[0]; ++i) {
        const Needle n = compass.read(padded.values.data() + (j + radius) * padded.stride + i + radius, places);
        maps.strength(i, j, k) = n.strength;
        maps.across_x(i, j, k) = n.x, maps.across_y(i, j, k) = n.y;
        maps.abnormality(i, j, k) = n.abnormality, maps.uncertainty_deg(i, j, k) = n.uncertainty_deg;
      }
  });
  return maps;
}

EdgeMap detect_edges(const Image& image, const Compass& options) {
  require_order(options.low, options.high, "compass");
  require_finite(image);
  CompassMaps maps = compass_maps(image, options);
  EdgeMap map{Mask(image.grid), std::move(maps.strength), {}, {}};
  if (options.subpixel) map.offsets = EdgeOffsets{Image(image.grid), Image(image.grid)};
  for_each_slice(image.grid, [&](int k) {
    const Slice strength = slice_of(map.gradient, k);
    const SliceVectors across{slice_of(maps.across_x, k), slice_of(maps.across_y, k)};
    trace(thin(strength, across), options.low, options.high, map.edges, k);
    if (options.subpixel) put_offsets(strength, across, map, k);
  });
  note_flat(map);
  return map;
}

}  // namespace dynasurf::image
