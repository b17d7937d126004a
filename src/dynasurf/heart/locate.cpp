#include "dynasurf/heart/locate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/heart/base_plane.hpp"
#include "dynasurf/heart/detail/hollow_shells.hpp"
#include "dynasurf/image/detail/linear_sampler.hpp"
#include "dynasurf/image/intensity.hpp"

namespace dynasurf::heart {
namespace {

constexpr double coarse_mm = 7;    // voxels of the search
constexpr double smooth_mm = 3.5;  // standard deviation of the smoothing before it

/// A smooth image on cubic voxels, in the world's axes of its own grid.
Image coarsened(const Image& smooth) {
  const Grid& from = smooth.grid;
  Grid grid = from;
  for (std::size_t a = 0; a < 3; ++a) {
    const double length = from.spacing[a] * (from.dims[a] - 1);
    grid.dims[a] = std::max(2, ceil_int(length / coarse_mm) + 1);
    grid.spacing[a] = coarse_mm;
  }
  Image result(grid);
  parallel_for(grid.dims[2], 1, [&](int begin, int end) {
    for (int k = begin; k < end; ++k)
      for (int j = 0; j < grid.dims[1]; ++j)
        for (int i = 0; i < grid.dims[0]; ++i)
          result(i, j, k) = image::sample_linear(smooth, centre_of(grid, {i, j, k}));
  });
  return result;
}

struct Candidate {
  LvShell cup;
  double worth = 0;
};

LvShell usual_cup(const Vec3& centre, const Vec3& axis, double radius) {
  return {centre, axis, radius, 1.35 * radius, 0.6 * radius};
}

/// How much a cup in the image is worth against others: its contrast, and not its brightness alone, since liver and
/// bladder are often the brightest things around.
double worth_of(const CupScore& s, double typical) { return s.contrast / (s.brightness + 0.25 * typical); }

Candidate best_cup(const Image& image, const Place& place, const std::vector<Vec3>& directions, double typical) {
  std::vector<Candidate> tries;
  for (const Vec3& axis : directions)
    for (double size : {0.8, 1.0, 1.2})
      for (double along : {-0.3, 0.0, 0.3}) {
        const LvShell cup = usual_cup(place.centre + along * place.radius_mm * axis, axis, size * place.radius_mm);
        tries.push_back({cup, score(image, cup).contrast});
      }
  std::stable_sort(tries.begin(), tries.end(),
                   [](const Candidate& a, const Candidate& b) { return a.worth > b.worth; });
  Candidate best;
  std::vector<Vec3> climbed;
  for (const Candidate& t : tries) {
    if (std::any_of(climbed.begin(), climbed.end(), [&](const Vec3& a) { return a.dot(t.cup.axis) > 0.7; })) continue;
    climbed.push_back(t.cup.axis);
    const LvShell cup = local_search(image, t.cup, 6, 3);
    const double worth = worth_of(score(image, cup), typical);
    if (worth > best.worth) best = {cup, worth};
    if (climbed.size() == 4) break;
  }
  if (!(best.worth > 0)) return best;
  const LvShell cup = local_search(image, best.cup, 1.5);
  return {cup, worth_of(score(image, cup), typical)};
}

double bright_level(const Image& image) { return quantile(image.values, 0.995); }

/// The cup grown about its apex.
LvShell grown(LvShell cup, double by) {
  const Vec3 apex = cup.apex();
  cup.radius_mm *= by, cup.half_length_mm *= by, cup.base_mm *= by;
  cup.centre = apex + cup.half_length_mm * cup.axis;
  return cup;
}

/// The cup fitted to the ridge of the wall, up to where the wall ends. A wall that goes on where the cup has closed
/// shows that the cup lies in the apical part of a wider one: with `may_grow` it is made wider then.
LvShell refined(const Image& image, LvShell cup, bool may_grow) {
  constexpr double usual_base = 0.55, highest_base = 0.75, most_growth = 1.3;
  constexpr std::array<double, 7> reaches_mm{12, 12, 12, 12, 10, 8, 8};
  for (std::size_t round = 0; round < reaches_mm.size(); ++round) {
    const std::optional<LvShell> fit = fit_cup(find_ridge(image, cup, 7, 16, reaches_mm[round]), cup);
    if (!fit) break;
    cup = *fit;
    const std::optional<BasePlane> base = find_base_plane(look_at_wall(image, cup));
    if (!base) continue;
    const double height = (base->point - cup.centre).dot(cup.axis);
    if (may_grow && round < 3 && height > highest_base * cup.half_length_mm)
      cup = grown(cup, std::min(most_growth, (1 + height / cup.half_length_mm) / (1 + usual_base)));
    cup.base_mm =
        std::clamp((base->point - cup.centre).dot(cup.axis), 0.1 * cup.half_length_mm, 0.85 * cup.half_length_mm);
  }
  return cup;
}

/// The cup in the same place with its apex where the base was.
LvShell exchanged(const LvShell& cup) {
  LvShell other = cup;
  other.axis = -cup.axis;
  other.centre = cup.middle() + (cup.middle() - cup.centre);
  return other;
}

/// Share of a dense set of directions in which the wall is a ridge near the cup.
double share_of_ridge(const Image& image, const LvShell& cup, double brightness, std::vector<double>* away = nullptr) {
  const std::vector<RidgePoint> ridge = find_ridge(image, cup, 6, 16, 10);
  std::size_t seen = 0;
  for (const RidgePoint& p : ridge) {
    if (!(p.prominence > 0.1 * brightness)) continue;
    ++seen;
    if (away) away->push_back(std::abs(p.offset_mm));
  }
  return 1.0 * seen / ridge.size();
}

/// The part of the image that every way to lay a cup has to explain.
struct Scene {
  const Image& image;
  Vec3 middle;
  double reach_mm = 0;
  double brightest = 0;  // what is brighter counts no more: hot neighbours
};

/// Share of the variance of a scene that a cup explains: an open wall whose brightness changes slowly with the
/// direction, a level inside and one around it. A wall that goes on beyond the supposed base is left unexplained, and
/// so is one that is not there; a defect costs little, for the brightness may follow it.
double explained_share(const Scene& scene, const LvShell& cup) {
  constexpr double step_mm = 7, half_wall_mm = 7.3, rim_mm = 3;  // half_wall: deviation of a smoothed wall
  constexpr int patterns = 9, unknowns = patterns + 2;
  using Row = Eigen::Matrix<double, unknowns, 1>;
  Eigen::Matrix<double, unknowns, unknowns> matrix = Eigen::Matrix<double, unknowns, unknowns>::Zero();
  Row right = Row::Zero();
  double sum = 0, squares = 0, count = 0;
  const ShellBasis a = across(cup.axis);
  const image::LinearSampler sample(scene.image);
  const auto look = [&](const Vec3& p) {
    const Index3 voxel = voxel_of(scene.image.grid, p);
    if (!scene.image.grid.contains(voxel[0], voxel[1], voxel[2])) return;
    const double value = std::min(sample(p), scene.brightest);
    const Vec3 d = p - cup.centre;
    const double height = d.dot(cup.axis), away = signed_distance(cup, p) / half_wall_mm;
    const double below = 1 / (1 + own::exp((height - cup.base_mm) / rim_mm)), ridge = own::exp(-0.5 * away * away);
    const Vec3 u =
        Vec3(d.dot(a.u) / cup.radius_mm, d.dot(a.v) / cup.radius_mm, height / cup.half_length_mm).stableNormalized();
    Row row;
    row << 1, u[0], u[1], u[2], u[0] * u[1], u[1] * u[2], u[0] * u[2], u[0] * u[0] - u[1] * u[1], 3 * u[2] * u[2] - 1,
        0, 0;
    row *= ridge * below;
    row[patterns] = 1;
    row[patterns + 1] = away < 0 ? (1 - ridge) * below : 0;
    matrix += row * row.transpose();
    right += value * row;
    sum += value, squares += value * value, ++count;
  };
  const int steps = scene.reach_mm / step_mm;
  for (int k = -steps; k <= steps; ++k)
    for (int j = -steps; j <= steps; ++j)
      for (int i = -steps; i <= steps; ++i)
        if (i * i + j * j + k * k <= steps * steps) look(scene.middle + step_mm * Vec3(i, j, k));
  const double variance = squares - sum * sum / count;
  if (!(variance > 0)) return 0;
  matrix.diagonal().array() += 5e-5 * count;  // patterns that are out of view stay small
  const Row level = matrix.ldlt().solve(right);
  return std::clamp(1 - (squares - 2 * level.dot(right) + level.dot(matrix * level)) / variance, 0.0, 1.0);
}

/// How well a cup lies in the wall and explains what is around it. The wall alone would not tell: where a defect takes
/// the apex away, what is left is a ring that is open at both ends, and a cup that leans into it is bright all over.
double worth_of(const Scene& scene, const LvShell& cup) {
  const CupScore s = score(scene.image, cup);
  std::vector<double> away;
  const double share = share_of_ridge(scene.image, cup, s.brightness, &away);
  if (away.empty()) return 0;
  const double spread = upper_median(away) / 5;
  return s.contrast * share * own::exp(-spread * spread) * own::pow(explained_share(scene, cup), 4);
}

/// The best refinement of a cup. The apical half of a wide ventricle is a good cup too, so wider ones are tried: they
/// see more ridge, nearer to an ellipsoid.
Candidate best_refinement(const Scene& scene, const LvShell& start) {
  constexpr std::array<double, 3> sizes{1.0, 1.25, 1.5};
  const LvShell climbed = local_search(scene.image, start, 3);
  std::array<Candidate, 2 * sizes.size()> tries;
  parallel_for(tries.size(), 1, [&](std::size_t n, std::size_t) {
    const bool may_grow = n % 2 != 0;
    const LvShell cup = refined(scene.image, grown(climbed, sizes[n / 2]), may_grow);
    tries[n] = {cup, worth_of(scene, cup)};
  });
  Candidate best{climbed, 0};
  for (const Candidate& t : tries)
    if (t.worth > best.worth) best = t;
  return best;
}

/// Blur draws the ridge of a curved wall inwards, by its variance times the mean curvature: little at the sides, some
/// millimetres at the apex. Put back for a usual camera and wall.
LvShell without_blur(LvShell cup) {
  constexpr double camera_mm = 12 / 2.3548, wall_mm = 10;
  constexpr double variance = smooth_mm * smooth_mm + camera_mm * camera_mm + wall_mm * wall_mm / 12;
  const double r = cup.radius_mm, l = cup.half_length_mm;
  cup.radius_mm += variance * (1 / r + r / (l * l)) / 2;
  cup.half_length_mm += variance * l / (r * r);
  return cup;
}

/// The cup where a person says it is; hints in the frame of the cup.
LvShell held(LvShell cup, const std::optional<Vec3>& middle, const std::optional<Vec3>& axis) {
  const Vec3 found = cup.middle();
  if (axis) cup.axis = *axis;
  cup.centre += middle.value_or(found) - cup.middle();
  return cup;
}

void describe_fit(const Image& image, Location& found) {
  const CupScore s = score(image, found.cup);
  found.contrast = s.relative();
  std::vector<double> away;
  found.ridge_share = share_of_ridge(image, found.cup, s.brightness, &away);
  if (!away.empty()) found.spread_mm = upper_median(away);
}

/// What a search looks at, and the best places for a usual cup in it, the best first. Grid frame.
struct Search {
  Image smooth;
  double typical = 0;  // brightness
  std::vector<Candidate> found;
  std::optional<Vec3> middle, axis;  // that were given
};

/// A person points at a heart from near its middle.
constexpr double pointed_mm = 25;

bool is_pointed_at(const Search& search, const LvShell& cup) {
  return !search.middle || (cup.middle() - *search.middle).norm() <= pointed_mm;
}

std::vector<Place> places_around(const Vec3& middle) {
  constexpr double step_mm = 8;
  std::vector<Place> places;
  for (const double r : shell_radii_mm) {
    places.push_back({middle, r, 1});
    for (int a = 0; a < 3; ++a)
      for (const double way : {-1.0, 1.0}) places.push_back({middle + way * step_mm * Vec3::Unit(a), r, 1});
  }
  return places;
}

Search search_in(const Image& mean, const LocateHints& hints) {
  Search search{image::smooth_gaussian(mean, smooth_mm), 0, {}, {}, {}};
  const Image coarse = coarsened(search.smooth);
  search.typical = bright_level(coarse);
  if (hints.centre_mm) search.middle = to_grid(mean.grid, *hints.centre_mm);
  if (hints.axis) search.axis = (mean.grid.direction.transpose() * *hints.axis).normalized();
  if (!(search.typical > 0)) return search;
  std::vector<Place> places = search.middle ? places_around(*search.middle) : find_places(coarse);
  if (hints.radius_mm)
    for (Place& p : places) p.radius_mm = *hints.radius_mm;
  const std::vector<Vec3> directions = search.axis ? std::vector{*search.axis} : cube_directions();
  search.found.resize(places.size());
  parallel_for(places.size(), 1, [&](std::size_t p, std::size_t) {
    search.found[p] = best_cup(coarse, places[p], directions, search.typical);
  });
  std::erase_if(search.found, [&](const Candidate& c) { return !(c.worth > 0 && is_pointed_at(search, c.cup)); });
  std::stable_sort(search.found.begin(), search.found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.worth > b.worth; });
  return search;
}

/// What is known of a cup that was found.
Location location_of(const Search& search, const LvShell& found, double other_end) {
  const Image& smooth = search.smooth;
  const auto kept = [&](const LvShell& cup) {
    return held(cup, is_pointed_at(search, cup) ? std::nullopt : search.middle, search.axis);
  };
  Location result;
  result.other_end = other_end;
  result.cup = kept(found);
  for (const Candidate& c : search.found)
    if ((c.cup.middle() - result.cup.middle()).norm() > 2 * places_apart_mm) {
      result.runner_up = c.worth / search.found.front().worth;
      result.runner_up_mm = to_world(smooth.grid, c.cup.middle());
      break;
    }
  describe_fit(smooth, result);
  result.cup = kept(without_blur(result.cup));
  result.outside = share_outside(smooth.grid, result.cup);
  result.cup = to_world(smooth.grid, result.cup);
  return result;
}

/// The heart at one of the places of a search.
std::optional<Location> settle_at(const Search& search, const LvShell& first) {
  const Scene scene{search.smooth, first.middle(), 2 * first.radius_mm + 25, 1.2 * search.typical};
  Candidate best = best_refinement(scene, first);
  if (!(best.worth > 0)) return std::nullopt;
  double other_end = 0;
  if (!search.axis) {
    Candidate other = best_refinement(scene, exchanged(best.cup));
    if (other.worth > best.worth) std::swap(best, other);
    other_end = other.cup.axis.dot(best.cup.axis) < 0 ? other.worth / best.worth : 0;
  }
  return location_of(search, best.cup, other_end);
}

/// Nearly the brightest value around a place.
double bright_around(const Image& smooth, const Vec3& middle) {
  constexpr double reach_mm = 50, step_mm = 5, bright = 0.97;
  constexpr int steps = reach_mm / step_mm;
  std::vector<float> values;
  for (int k = -steps; k <= steps; ++k)
    for (int j = -steps; j <= steps; ++j)
      for (int i = -steps; i <= steps; ++i) {
        const Vec3 p = middle + step_mm * Vec3(i, j, k);
        const Index3 voxel = voxel_of(smooth.grid, p);
        if (i * i + j * j + k * k <= steps * steps && smooth.grid.contains(voxel[0], voxel[1], voxel[2]))
          values.push_back(image::sample_linear(smooth, p));
      }
  return quantile(values, bright);
}

/// Whether the brighter part of a wall is brighter than what it encloses.
bool is_hollow(const Image& smooth, const LvShell& cup) {
  constexpr double brighter_part = 0.75;
  std::vector<double> wall;
  for (const RidgePoint& p : find_ridge(smooth, cup, 6, 16, 10)) wall.push_back(p.brightness);
  const std::size_t rank = brighter_part * wall.size();
  return of_rank(std::move(wall), rank) > image::sample_linear(smooth, cup.middle());
}

/// The cup that explains best what lies around a place at which a person points: a ring too, of whose wall half is not
/// seen. Absent where nothing there is hollow.
std::optional<Location> explain_around(const Search& search) {
  constexpr double reach_mm = 65;
  constexpr std::size_t refined_cups = 8;
  const Image& smooth = search.smooth;
  const Vec3& middle = *search.middle;
  const Scene scene{smooth, middle, reach_mm, 1.2 * bright_around(smooth, middle)};
  std::vector<Candidate> tries;
  for (const Vec3& axis : search.axis ? std::vector{*search.axis} : cube_directions())
    for (const double radius : shell_radii_mm)
      tries.push_back({held(usual_cup(middle, axis, radius), middle, std::nullopt), 0});
  const auto explain = [&](std::span<Candidate> cups) {
    parallel_for(cups.size(), 1,
                 [&](std::size_t n, std::size_t) { cups[n].worth = own::pow(explained_share(scene, cups[n].cup), 4); });
    std::stable_sort(cups.begin(), cups.end(),
                     [](const Candidate& a, const Candidate& b) { return a.worth > b.worth; });
  };
  explain(tries);
  std::vector<Candidate> cups;
  for (std::size_t n = 0; n < std::min(refined_cups, tries.size()); ++n)
    for (const bool may_grow : {false, true}) {
      const LvShell cup = held(refined(smooth, tries[n].cup, may_grow), std::nullopt, search.axis);
      if (is_pointed_at(search, cup) && is_hollow(smooth, cup)) cups.push_back({cup, 0});
    }
  if (cups.empty()) return std::nullopt;
  explain(cups);
  std::vector<Candidate> other{{refined(smooth, exchanged(cups.front().cup), false), 0}};
  explain(other);
  Location result = location_of(search, cups.front().cup, search.axis ? 0 : other.front().worth / cups.front().worth);
  result.is_pointed_at = true;
  return result;
}

/// The heart at the best place of a search or, where no wall is clearly seen there, at the next ones that lie apart.
std::optional<Location> best_of(const Search& search, int most_places) {
  std::optional<Location> first;
  std::vector<Vec3> seen;
  for (const Candidate& c : search.found) {
    const auto is_near = [&](const Vec3& place) { return (place - c.cup.middle()).norm() < places_apart_mm; };
    if (std::any_of(seen.begin(), seen.end(), is_near)) continue;
    std::optional<Location> here = settle_at(search, c.cup);
    if (here && here->is_clear()) return here;
    if (seen.empty()) first = std::move(here);
    seen.push_back(c.cup.middle());
    if (std::ssize(seen) >= most_places) break;
  }
  return first;
}

double clarity(const Location& l) { return l.contrast * l.ridge_share; }

/// Hot gut and its streaks may pass for a wall that is just seen, not for one as good as this.
bool is_plain(const Location& l) { return l.contrast >= 0.35 && l.ridge_share >= 0.8; }

Image cut_at(Image image, float most) {
  for (float& value : image.values) value = std::min(value, most);
  return image;
}

/// The heart in the volume with its brightness cut at five levels, each lower than the one before, from `most`
/// downwards; `most` becomes the last. A cut that takes a large part of the volume cuts more than what is hot.
std::vector<std::optional<Location>> looks_with_cuts(const Image& mean, const LocateHints& hints, int places,
                                                     double& most) {
  constexpr double dimmer = 0.6, large_part = 0.2;
  std::array<float, 5> cuts;
  for (float& cut : cuts) cut = most *= dimmer;
  std::vector<std::optional<Location>> looks(cuts.size());
  // Side by side, but for volumes of which several at once would be much memory.
  constexpr std::size_t much_memory = 4'000'000;
  const std::size_t grain = mean.values.size() < much_memory ? 1 : looks.size();
  parallel_for(looks.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const double above = std::count_if(mean.values.begin(), mean.values.end(), [&](float v) { return v > cuts[n]; });
      if (above < large_part * mean.values.size()) looks[n] = best_of(search_in(cut_at(mean, cuts[n]), hints), places);
    }
  });
  return looks;
}

}  // namespace

Image mean_image(std::span<const Image> gates) {
  Image mean(gates.front().grid);
  parallel_for(mean.values.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (const Image& gate : gates)
      for (std::size_t v = begin; v < end; ++v) mean.values[v] += gate.values[v] / gates.size();
  });
  return mean;
}

std::optional<Location> locate(const Image& mean, const LocateHints& hints) {
  constexpr int many_places = 5;
  const Search uncut = search_in(mean, hints);
  std::optional<Location> best = best_of(uncut, many_places);
  if (best && is_plain(*best)) return best;
  // Something hotter than the wall may draw the search to itself. How bright the wall is, is not known: the cut falls
  // to a thirteenth of the peak, and where no wall is seen then, to a hundred-and-sixtieth; the look that sees a wall
  // best counts. One that is clear uncut stays unless a cut shows a much clearer one.
  constexpr double much = 1.5;
  const bool is_clear_uncut = best && best->is_clear();
  double beaten = best ? (is_clear_uncut ? much : 1) * clarity(*best) : 0;
  double most = *std::max_element(mean.values.begin(), mean.values.end());
  const int rounds = hints.centre_mm ? 1 : 2;
  for (int round = 0; round < rounds && !(round > 0 && best && best->is_clear()); ++round)
    for (const std::optional<Location>& look : looks_with_cuts(mean, hints, is_clear_uncut ? 1 : many_places, most))
      if (look && look->is_clear() && clarity(*look) > beaten) best = look, beaten = clarity(*look);
  if (!hints.centre_mm || (best && best->is_clear())) return best;
  const std::optional<Location> explained = explain_around(uncut);
  return explained ? explained : best;
}

}  // namespace dynasurf::heart
