#include "batch_search.hpp"

#include <algorithm>
#include <filesystem>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/study_io.hpp"

#include "cloud_search.hpp"
#include "console.hpp"
#include "result_job.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

std::string left_out_text(const io::StudySearch& found, const fs::path& folder) {
  std::string text = "path\treason\n";
  for (const io::StudySearch::LeftOut& file : found.left_out) {
    std::string path = file.file.lexically_relative(folder).string();
    std::replace_if(
        path.begin(), path.end(), [](unsigned char c) { return c < 32 || c == 127; }, ' ');
    text += path + "\t" + file.reason + "\n";
  }
  return text;
}

}  // namespace

cohort::StudyList search_for_cohort(const CohortSearch& a, const std::stop_token& stop) {
  const fs::path folder = fs::weakly_canonical(a.input), cohort = fs::weakly_canonical(a.cohort);
  if (cohort == folder) throw OptionError("--out " + a.cohort + ": is the folder of the studies; expected another");
  io::StudySearch found;
  run_with_progress(a.quiet, stop, [&](const Progress& progress) {
    found = a.clouds ? search_clouds(folder, progress) : io::search_studies(folder, progress);
  });
  // Results may stand below the folder of the studies: they are none.
  const auto is_own = [&](const fs::path& file) {
    const fs::path inside = file.lexically_relative(cohort);
    return !inside.empty() && *inside.begin() != "..";
  };
  std::erase_if(found.studies, [&](const auto& study) { return is_own(study.files.front()); });
  std::erase_if(found.left_out, [&](const auto& file) { return is_own(file.file); });
  if (found.studies.empty())
    throw InputError(a.clouds ? a.input + ": holds no cloud; expected files such as .ply, .xyz, .las or .stl"
                              : a.input + ": holds no gated heart study; " + std::to_string(found.left_out.size()) +
                                    " files are of another kind; expected gated short-axis studies");
  io::write_file(cohort / "left_out.tsv", left_out_text(found, folder));
  if (!a.quiet)
    print(std::to_string(found.studies.size()) + " studies found, " + std::to_string(found.left_out.size()) +
          " files left out: " + (fs::path(a.cohort) / "left_out.tsv").string() + "\n");
  return cohort::list_of(found, folder, cohort / "inputs");
}

}  // namespace dynasurf::app
