#include "dynasurf/cohort/detail/bids.hpp"

#include <algorithm>
#include <map>

#include <nlohmann/json.hpp>

#include "dynasurf/cohort/detail/job_key.hpp"
#include "dynasurf/cohort/detail/table.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/json_read.hpp"

namespace dynasurf::cohort {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The name without "_nm" and its ending; empty for another file.
std::string stem_of(const fs::path& file) {
  const std::string name = file.filename().string();
  for (const char* ending : {"_nm.nii.gz", "_nm.nii", "_nm.dcm", "_nm.nrrd"})
    if (name.ends_with(ending)) return name.substr(0, name.size() - std::string_view(ending).size());
  return {};
}

std::vector<fs::path> sorted_entries(const fs::path& folder, const std::string& prefix) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().filename().string().starts_with(prefix)) entries.push_back(it->path());
  if (error) throw IoError(folder.string() + ": cannot list this folder: " + error.message());
  std::sort(entries.begin(), entries.end());
  return entries;
}

/// Columns of participants.tsv become columns of the list of studies, where these names have a meaning of their own.
bool is_group_column(const std::string& name) {
  return name != "path" && name != "id" && name != "series" && name != "fwhm" && name != "fwhm_mm" &&
         name != "options" &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") ==
             std::string::npos &&
         (name.front() < '0' || name.front() > '9');
}

}  // namespace

std::vector<BidsStudy> bids_studies(const fs::path& dataset) {
  std::vector<BidsStudy> studies;
  for (const fs::path& participant : sorted_entries(dataset, "sub-")) {
    if (!fs::is_directory(participant)) continue;
    // Sessions are optional in BIDS: the data stand in them, or in the folder of the participant itself.
    std::vector<fs::path> places = sorted_entries(participant, "ses-");
    places.insert(places.begin(), participant);
    for (const fs::path& place : places) {
      if (!fs::is_directory(place / "nm")) continue;
      for (const fs::path& file : sorted_entries(place / "nm", "sub-")) {
        BidsStudy one;
        one.study.id = stem_of(file);
        if (one.study.id.empty()) continue;
        one.study.path = file;
        one.participant = participant.filename().string();
        one.folder = (place / "nm").lexically_relative(dataset);
        studies.push_back(std::move(one));
      }
    }
  }
  if (studies.empty())
    throw InputError(dataset.string() +
                     ": holds no sub-LABEL/[ses-LABEL/]nm/*_nm.nii.gz, .nii, .nrrd or .dcm; expected a "
                     "BIDS dataset with the datatype nm");
  return studies;
}

StudyList bids_list(const fs::path& dataset, std::vector<BidsStudy>& studies) {
  StudyList list;
  const fs::path file = dataset / "participants.tsv";
  std::map<std::string, std::vector<std::string>> groups_of;
  if (fs::exists(file)) {
    const auto table = detail::parse_tsv(io::text_of_file(file), file.string());
    if (table.head.empty() || table.head.front() != "participant_id")
      throw InputError(file.string() + ": line 1: expected participant_id as the first column");
    std::vector<std::size_t> columns;
    for (std::size_t n = 0; n < table.head.size(); ++n)
      if (is_group_column(table.head[n])) columns.push_back(n), list.group_columns.push_back(table.head[n]);
    for (const auto& row : table.rows)
      for (const std::size_t n : columns)
        groups_of[row.cells.front()].push_back(row.cells[n] == "n/a" ? "" : row.cells[n]);
  } else {
    list.group_columns = {"participant_id"};
  }
  for (BidsStudy& one : studies) {
    one.study.groups = groups_of[one.participant];
    one.study.groups.resize(list.group_columns.size());
    if (list.group_columns.front() == "participant_id") one.study.groups.front() = one.participant;
    list.studies.push_back(one.study);
  }
  return list;
}

void describe_derivatives(const fs::path& out, const std::string& version) {
  Json json = Json::object();
  json["Name"] = "Dynasurf";
  json["BIDSVersion"] = "1.8.0";
  json["DatasetType"] = "derivative";
  json["GeneratedBy"] = Json::array(
      {{{"Name", "dynasurf"}, {"Version", version}, {"Description", "Surfaces and volumes of the left ventricle"}}});
  io::write_file(out / "dataset_description.json", io::json_text(json));
  io::write_file(out / ".bidsignore", "**/nm/\nsub-*/nm/\ncohort/\n");
}

void publish_derivatives(const fs::path& out, const BidsStudy& one) {
  const fs::path result = result_folder(out / "cohort", one.study.id);
  const fs::path stem = out / one.folder / (one.study.id + "_desc-dynasurf");
  io::write_file(stem.string() + "_report.html", io::text_of_file(result / "report.html"));
  io::write_file(stem.string() + "_results.json", io::text_of_file(result / "results.json"));
  Json sidecar = Json::object();
  sidecar["Description"] = "Report of dynasurf ventricle; the whole result is in the folder ResultFolder";
  sidecar["Sources"] = Json::array({"bids:raw:" + (one.folder / one.study.path.filename()).generic_string()});
  sidecar["ResultFolder"] = result.lexically_relative(out).generic_string();
  io::write_file(stem.string() + "_report.json", io::json_text(sidecar));
}

}  // namespace dynasurf::cohort
