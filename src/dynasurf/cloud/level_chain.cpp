#include "dynasurf/cloud/detail/level_chain.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <string>

#include "dynasurf/cloud/detail/support.hpp"
#include "dynasurf/cloud/detail/transfer.hpp"
#include "dynasurf/cloud/detail/words.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {

bool is_open(const Facts& facts) { return facts.boundary != BoundaryRule::close; }

LevelPlan plan_of(const Options& options, const Facts& facts, std::size_t triangles) {
  LevelPlan plan = options.method == CloudMethod::faithful ? faithful_plan() : shaped_plan();
  plan.sharp_deg = options.keep_sharp ? 40 : 60;
  if (is_noisy(facts)) {
    // The smaller the triangles against the noise, the more their vertices must share; measured on noisy bodies.
    const double edge = 1.5 / std::sqrt(triangles);  // of the diagonal, for common bodies
    plan.noise = facts.noise / facts.diagonal;
    plan.points_per_triangle *= 2;
    plan.smoothness += 1400 * own::pow(plan.noise / edge, 5);
  }
  return plan;
}

namespace {

constexpr int fewest_triangles = 20;

LevelMaker maker_of(const Fitting& f, std::size_t triangles) {
  return {f.fine, f.on_fine, f.points, triangles, plan_of(f.options, f.facts, triangles)};
}

void make(const Fitting& f, mesh::SurfaceEditor& surface, std::size_t triangles) {
  make_level(surface, triangles, f.fine, f.on_fine, f.points, plan_of(f.options, f.facts, triangles));
}

/// Edges of a boundary go with one triangle each, so an open surface may have one or two less.
bool has_as_asked(std::size_t triangles, int asked, const Facts& facts) {
  const std::size_t wanted = asked;
  return triangles == wanted || (is_open(facts) && triangles < wanted && triangles + 2 >= wanted);
}

/// A start without the field's own shape may stop before a deep cavity: the points in it lie far from the mesh and near
/// the field's surface.
void tell_unreached(const TriMesh& mesh, const Fitting& fitting, Notes& notes) {
  constexpr double far = 0.01, worth_telling = 0.002;  // of the diagonal; of the points
  const mesh::ClosestPoint closest(mesh);
  const std::span<const Vec3> points = fitting.scanned;
  const double count = parallel_sum(points.size(), 1024, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const double distance2 = closest(points[i]).distance2;
      sum += distance2 > far * far && fitting.on_fine(points[i]).distance2 < 0.25 * distance2;
    }
    return sum;
  });
  const double share = count / points.size();
  if (share > worth_telling)
    notes.push_back({Severity::warning, "cloud.start",
                     "the start of shape " + std::string(word_of(fitting.options.start)) + " did not reach " +
                         percent(share) + " of the points, which lie farther than " + percent(far) +
                         " of the diagonal from its surface"});
}

/// The levels of `make_levels`.
class LevelChain {
 public:
  LevelChain(const Fitting& fitting, const std::vector<int>& triangles, const Measure& measure,
             const Progress& progress)
      : fitting_(fitting), triangles_(triangles), measure_(measure), progress_(progress), made_(triangles.size()) {}

  std::vector<MeasuredLevel> made_from(mesh::SurfaceEditor surface) {
    progress_("levels", 0, triangles_.size());
    make(0, std::move(surface));
    return std::move(made_);
  }

 private:
  void make(std::size_t i, mesh::SurfaceEditor surface) {
    progress_.check();
    const LevelMaker maker = maker_of(fitting_, triangles_[i]);
    maker.begin(surface);
    if (i + 1 == triangles_.size()) return finish(i, maker, surface);
    mesh::SurfaceEditor begun = surface;
    parallel_for(2, 1, [&](std::size_t task, std::size_t) {
      if (task == 0)
        make(i + 1, std::move(begun));
      else
        finish(i, maker, surface);
    });
  }

  void finish(std::size_t i, const LevelMaker& maker, mesh::SurfaceEditor& surface) {
    progress_.check();
    maker.finish(surface);
    TriMesh mesh = surface.mesh();
    Notes notes;
    const CloudStart start = fitting_.options.start;
    if (i == 0 && start != CloudStart::automatic && start != CloudStart::field) tell_unreached(mesh, fitting_, notes);
    made_[i] = measure_(std::move(mesh), triangles_[i]);
    made_[i].notes.insert(made_[i].notes.begin(), notes.begin(), notes.end());
    const std::lock_guard lock(guard_);
    progress_("levels", ++done_, triangles_.size());
  }

  const Fitting& fitting_;
  const std::vector<int>& triangles_;
  const Measure& measure_;
  const Progress& progress_;
  std::vector<MeasuredLevel> made_;
  std::mutex guard_;
  int done_ = 0;
};

}  // namespace

MeasuredLevel measure_level(const PreparedCloud& p, const Facts& facts, int asked, TriMesh mesh) {
  auto [certificate, errors] = compare(mesh, p.neighbours);
  Notes notes;
  if (!is_open(facts) && !certificate.watertight())
    notes.push_back({Severity::failure, "cloud.not_watertight",
                     "the level of " + std::to_string(asked) + " triangles is not watertight"});
  if (is_open(facts) && !certificate.sound_open())
    notes.push_back({Severity::failure, "cloud.not_sound",
                     "the level of " + std::to_string(asked) + " triangles is no sound open surface"});
  if (!has_as_asked(certificate.triangles, asked, facts))
    notes.push_back(
        {Severity::warning, "cloud.triangles",
         "the level of " + std::to_string(asked) + " triangles has " + std::to_string(certificate.triangles)});
  auto colours = colours_at_vertices(mesh, p.cloud, p.neighbours);
  auto confidence = confidences(mesh, {p.cloud.points, p.neighbours, p.facts});
  return {{asked, std::move(mesh), certificate, std::move(errors), std::move(confidence), std::move(colours)},
          std::move(notes)};
}

std::vector<MeasuredLevel> make_levels(mesh::SurfaceEditor surface, const Fitting& fitting,
                                       const std::vector<int>& triangles, const Measure& measure,
                                       const Progress& progress) {
  return LevelChain(fitting, triangles, measure, progress).made_from(std::move(surface));
}

/// The error falls about as the number grows, so each try starts where the line through the last two, on logarithmic
/// scales, meets the error asked for.
int fewest_within(mesh::SurfaceEditor& surface, const Fitting& fitting, double error, Notes& notes,
                  const Progress& progress) {
  constexpr int first_try = 1280;
  constexpr double step = 1.1, as_good = 0.999;
  struct Try {
    int count = 0;
    double error = 0;
  };
  // What the lattice could not see, more triangles cannot add.
  const int most = std::clamp<int>(surface.triangles() / 2 * 2, 1000, most_triangles_within_error);
  const mesh::SurfaceEditor finest = std::move(surface);
  std::optional<Try> near, far, last;
  mesh::SurfaceEditor nearest = finest;
  int count = std::min(first_try, most);
  for (;;) {
    progress.check();
    mesh::SurfaceEditor tried = near ? nearest : finest;
    make(fitting, tried, count);
    const bool is_made = has_as_asked(tried.triangles(), count, fitting.facts);
    const Try now{count, mean_distance(tried, fitting.scanned)};
    if (is_made && now.error <= error) {
      near = now;
      nearest = std::move(tried);
    } else {
      far = now;
      if (count == most) nearest = std::move(tried);
    }
    if (far && far->count == most) {
      notes.push_back(
          {Severity::warning, "cloud.max_error",
           "no level of up to " + std::to_string(most) + " triangles is as near to the points as asked for"});
      near = far;
      break;
    }
    const int fewest = far ? far->count + 2 : fewest_triangles;
    if (near && (near->count <= fewest || (far && near->count <= step * far->count + 2))) break;
    double slope = -1;
    if (last && last->count != now.count && last->error != now.error)
      slope = std::clamp(own::log(now.error / last->error) / own::log(1.0 * now.count / last->count), -2.0, -0.3);
    const double guess = now.count * own::pow(as_good * error / now.error, 1 / slope);
    const double low = far ? std::sqrt(step) * far->count : fewest_triangles;
    const double high = near ? near->count / std::sqrt(step) : most;
    const int next = std::clamp(guess, std::min(low, high), high);
    count = std::clamp(next / 2 * 2, fewest, near ? near->count - 2 : most);
    last = now;
  }
  surface = std::move(nearest);
  return near->count;
}

}  // namespace dynasurf::cloud
