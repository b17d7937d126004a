#include "cloud_run.hpp"

#include <sys/resource.h>

#include "dynasurf/core/detail/stage_clock.hpp"
#include "dynasurf/core/detail/trace.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/report/detail/run_record.hpp"
#include "dynasurf/report/result_folders.hpp"

#include "console.hpp"
#include "kept_stages.hpp"
#include "live_page.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

/// The most memory that this process has held; 0 where the system does not tell.
std::size_t peak_bytes() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? static_cast<std::size_t>(usage.ru_maxrss) * 1024 : 0;
}

}  // namespace

CloudOutcome reconstruct_cloud_to_folder(const CloudJob& job, const Progress& progress) {
  const ThreadLimit limit(job.threads);
  std::vector<fs::path> inputs = job.clouds;
  if (!job.options_file.empty()) inputs.push_back(job.options_file);
  io::OutputFolder folder(job.out, job.existing, inputs);  // first: a place that cannot be written to costs no time
  CloudOutcome outcome;
  StageClock clock(outcome.run.seconds);
  const Progress timed{[&](std::string_view stage, int done, int total) {
                         clock.enter(stage);
                         progress(stage, done, total);
                       },
                       progress.stop};
  timed("read", 0, 1);
  io::CloudInput input = io::read_cloud(job.clouds);
  const report::Provenance provenance = provenance_of(job, job.clouds, io::options_to_text(job.options));
  progress.check();

  outcome.run.sources = std::move(input.sources);
  try {
    cloud::StageCache* const kept = kept_stages(input.cloud);
    outcome.run.result = cloud::reconstruct(std::move(input.cloud), job.options, timed, kept);
  } catch (const InputError& error) {  // the library knows the points, not the file they came from
    throw InputError(job.clouds.front().string() + ": " + error.what());
  }
  Notes& notes = outcome.run.result.notes;
  notes.insert(notes.begin(), input.notes.begin(), input.notes.end());
  progress.check();

  timed("write", 0, 1);
  report::write_cloud_files(outcome.run, provenance, {job.mesh_formats, job.textures, job.packed}, folder.path());
  clock.stop();
  outcome.run.peak_bytes = peak_bytes();
  outcome.json = report::cloud_results_text(
      outcome.run, provenance,
      {job.mesh_formats, job.textures, job.packed, job.timings ? report::Timings::keep : report::Timings::omit});
  io::write_file(folder.path() / "results.json", outcome.json);
  if (!job.live_page.empty()) write_live_page(job.live_page, job.clouds, folder.path());
  progress.check();
  const TraceStage noted("publish");
  folder.publish();
  outcome.moved_to = folder.moved_to();
  return outcome;
}

std::string summary_of(const report::CloudRun& run) {
  const cloud::Result& result = run.result;
  const bool is_closed = result.facts.boundary == cloud::BoundaryRule::close;
  std::vector<std::vector<std::string>> rows{{"level", "triangles", is_closed ? "watertight" : "boundary loops",
                                              "parts", "genus", "smallest angle", "mean distance", "largest"}};
  for (std::size_t n = 0; n < result.levels.size(); ++n) {
    const cloud::Certificate& c = result.levels[n].certificate;
    const auto share = [&](double length) {
      return c.cloud_diagonal > 0 ? fixed(100 * length / c.cloud_diagonal, 3) + " %" : std::string("-");
    };
    rows.push_back({std::to_string(n + 1), std::to_string(c.triangles),
                    !is_closed       ? std::to_string(c.boundary_loops)
                    : c.watertight() ? "yes"
                                     : "no",
                    std::to_string(c.components), c.genus ? std::to_string(*c.genus) : "-",
                    fixed(c.smallest_angle_deg, 1) + " deg", share(c.cloud_to_mesh_mean),
                    share(c.cloud_to_mesh_largest)});
  }
  std::string text = table(rows);
  for (std::size_t n = 0; n < result.levels.size(); ++n) {
    const cloud::Certificate& c = result.levels[n].certificate;
    if (is_sound(result, result.levels[n])) continue;
    text += "level " + std::to_string(n + 1) + (is_closed ? " is not watertight:" : " is no sound open surface:");
    if (is_closed && !c.closed) text += " not closed;";
    if (!c.manifold) text += " not manifold;";
    if (!c.oriented) text += " not oriented alike;";
    if (is_closed && !c.outward) text += " turned inside out;";
    if (c.self_intersections > 0) text += " " + std::to_string(c.self_intersections) + " pairs of triangles meet;";
    if (c.flat_triangles > 0) text += " " + std::to_string(c.flat_triangles) + " flat triangles;";
    text.back() = '\n';
  }
  if (!is_closed)
    text += "open surface with " + std::to_string(result.facts.boundary_loops) + " boundary " +
            (result.facts.boundary_loops == 1 ? "loop" : "loops") + " (boundary " +
            std::string(word_of(result.facts.boundary)) + ")\n";
  text += "verdict: " + std::string(word_of(cloud::verdict_of(result))) + "\n";
  std::size_t remarks = 0;
  for (const Note& note : result.notes) {
    if (note.severity == Severity::info) ++remarks;
    if (note.severity != Severity::info) text += "  " + line_of(note) + "\n";
  }
  if (remarks > 0) text += std::to_string(remarks) + " remarks in results.json and report.html\n";
  return text;
}

}  // namespace dynasurf::app
