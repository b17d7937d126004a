#include "phantom_patients.hpp"

#include <atomic>
#include <charconv>
#include <mutex>

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

#include "console.hpp"
#include "phantom_truth.hpp"
#include "result_job.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int patients_per_folder = 100;

/// With zeros before it, so that names sort as numbers do.
std::string digits(int number, std::size_t width) {
  const std::string text = std::to_string(number);
  return std::string(width - std::min(width, text.size()), '0') + text;
}

std::uint64_t seed_of(const std::string& text) {
  std::uint64_t seed = 1;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (!text.empty() && (error != std::errc{} || rest != text.data() + text.size()))
    throw OptionError("--seed is " + text + "; expected a whole number from 0 on");
  return seed;
}

/// One study of the population, before it is made.
struct Planned {
  std::string id, subject;
  fs::path folder;  // below the job's
  synthetic::DrawnPatient patient;
};

Planned plan(const PatientsJob& job, std::uint64_t seed, int study) {
  const int number = study / job.repeats, repeat = study % job.repeats;
  Planned planned;
  planned.subject = "p" + digits(number + 1, 6);
  planned.id = planned.subject + (job.repeats > 1 ? "-" + digits(repeat + 1, 2) : "");
  planned.folder = fs::path(digits(number / patients_per_folder, 4)) / planned.id;
  planned.patient = synthetic::draw_patient(seed, number, repeat);
  if (job.small) {
    planned.patient.options.lattice = synthetic::small_lattice();
    planned.patient.options.gates = 4;
  }
  set_options(planned.patient.options, job.settings);
  return planned;
}

/// The truth of a patient that stands there; null where there is none. Throws IoError where it is another one.
Json former_truth(const fs::path& folder, const Planned& planned) {
  const fs::path file = folder / "truth.json";
  if (!fs::exists(file)) return nullptr;
  Json truth = io::read_json(file);
  const io::JsonNode root = io::root_of(truth, file.string());
  synthetic::VirtualPatient options = planned.patient.options;
  if (*io::object_in(root, "options").json != io::options_to_json(nodes_of(options)))
    throw IoError(folder.string() +
                  ": is a patient of other options; expected another --out, or the --seed, --set and "
                  "--repeats it was made with");
  return truth;
}

Json make_patient(const fs::path& folder, const Planned& planned, const report::LabelOutput& labels) {
  if (Json truth = former_truth(folder, planned);
      !truth.is_null() && report::has_wall_labels(labels, folder / "labels"))
    return truth;
  const synthetic::Phantom phantom = synthetic::make_phantom(synthetic::PhantomOptions(planned.patient.options));
  Json truth = truth_of(phantom);
  io::OutputFolder output(folder);
  io::DicomWriteOptions dicom = finely_stored(phantom.study, "Dynasurf phantom patient");
  dicom.patient_name = "PHANTOM^" + planned.subject;
  dicom.patient_id = planned.subject;
  io::write_dicom(without_negative(phantom.study), output.path() / "study.dcm", dicom);
  if (!labels.ending.empty()) io::write_nifti(phantom.study, output.path() / ("study." + labels.ending));
  write_true_labels(phantom, labels, output.path() / "labels");
  io::write_file(output.path() / "truth.json", io::json_text(truth));
  output.publish();
  return truth;
}

constexpr std::string_view head =
    "id\tpath\tsubject\tsex\tage_years\tsite\tdefect\tfwhm_true_mm\tedv_true_ml\tesv_true_ml\tef_true_percent\t"
    "wall_true_ml\n";

std::string row_of(const Planned& planned, const Json& truth) {
  const auto cell = [&](const char* key) {
    return "\t" + (truth.contains(key) ? truth.at(key).dump() : std::string());
  };
  const synthetic::DrawnPatient& p = planned.patient;
  return planned.id + "\t" + (planned.folder / "study.dcm").string() + "\t" + planned.subject + "\t" +
         std::string(p.sex) + "\t" + std::to_string(p.age_years) + "\t" + std::string(p.site) + "\t" +
         std::string(word_of(p.options.defect)) + cell("fwhm_mm") + cell("edv_ml") + cell("esv_ml") +
         cell("ef_percent") + "\t" + truth.at("gates").at(0).at("wall_ml").dump() + "\n";
}

std::string make_rows(const PatientsJob& job, std::uint64_t seed, const Progress& progress) {
  const int studies = job.count * job.repeats;
  std::vector<std::string> rows(studies);
  std::mutex telling;
  int made = 0;
  parallel_for(rows.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      progress.check();
      const Planned planned = plan(job, seed, n);
      rows[n] = row_of(planned, make_patient(job.out / planned.folder, planned, job.labels));
      const std::lock_guard lock(telling);
      progress("patients", ++made, studies);
    }
  });
  std::string table(head);
  for (const std::string& row : rows) table += row;
  return table;
}

}  // namespace

ExitCode make_patients(const PatientsJob& job, const std::stop_token& stop) {
  const std::uint64_t seed = seed_of(job.seed);
  plan(job, seed, 0);  // a wrong setting is told before anything is made
  run_with_progress(job.quiet, stop, [&](const Progress& progress) {
    io::write_file(job.out / "patients.tsv", make_rows(job, seed, progress));
  });
  if (!job.quiet)
    print(std::to_string(job.count * job.repeats) + " studies of " + std::to_string(job.count) +
          " patients\ntruth: " + (job.out / "patients.tsv").string() + "\n");
  return done;
}

}  // namespace dynasurf::app
