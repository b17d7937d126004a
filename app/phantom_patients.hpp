#pragma once
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "dynasurf/report/detail/label_volumes.hpp"

#include "command.hpp"

namespace dynasurf::app {

/// A population of virtual patients, each a folder with study.dcm and truth.json, and patients.tsv with a row a study.
struct PatientsJob {
  std::filesystem::path out;
  int count = 0, repeats = 1;
  std::string seed;                   // empty: 1
  std::vector<std::string> settings;  // of every patient, over what is drawn
  bool small = false, quiet = false;
  report::LabelOutput labels;  // of the true walls, beside study.nii.gz
};

/// Several patients at a time. Patients that stand there from an earlier call with the same options are kept. Throws
/// OptionError, IoError, Cancelled; what was made until then stays and is kept by the next call.
ExitCode make_patients(const PatientsJob& job, const std::stop_token& stop);

}  // namespace dynasurf::app
