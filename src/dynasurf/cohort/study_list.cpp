#include "dynasurf/cohort/study_list.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include "dynasurf/cohort/detail/table.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/digest.hpp"

namespace dynasurf::cohort {
namespace {

namespace fs = std::filesystem;
using detail::TextTable;

[[noreturn]] void refuse(const std::string& name, std::size_t line, const std::string& what) {
  throw InputError(name + ": line " + std::to_string(line) + ": " + what);
}

bool is_letter_or_digit(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); }

/// An id becomes the name of files and folders: nothing in it that a path or a table could take for more.
bool is_id(const std::string& id) {
  return !id.empty() && id.size() <= 64 && id.front() != '.' && std::all_of(id.begin(), id.end(), [](char c) {
    return is_letter_or_digit(c) || c == '.' || c == '_' || c == '-';
  });
}

bool is_column_name(const std::string& name) {
  return !name.empty() && name.size() <= 64 && is_letter_or_digit(name.front()) &&
         (name.front() < '0' || name.front() > '9') &&
         std::all_of(name.begin(), name.end(), [](char c) { return is_letter_or_digit(c) || c == '_'; });
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find(' ', from), text.size());
    if (to > from) words.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  return words;
}

double fwhm_of(const std::string& cell, const std::string& name, std::size_t line) {
  double value = 0;
  const auto [rest, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc{} || rest != cell.data() + cell.size() || !(value >= 0 && value <= 100))
    refuse(name, line, "fwhm_mm is " + cell + "; expected millimetres from 0 to 100");
  return value;
}

/// What the columns of a table are, by position.
struct Columns {
  std::optional<std::size_t> path, id, series, fwhm, options;
  std::vector<std::size_t> groups;
};

Columns columns_of(const TextTable& table, const std::string& name) {
  Columns columns;
  const std::map<std::string, std::optional<std::size_t>*> known{
      {"path", &columns.path},    {"id", &columns.id},     {"series", &columns.series},
      {"fwhm_mm", &columns.fwhm}, {"fwhm", &columns.fwhm}, {"options", &columns.options}};
  for (std::size_t n = 0; n < table.head.size(); ++n) {
    const auto at = known.find(table.head[n]);
    if (at == known.end()) {
      if (!is_column_name(table.head[n]))
        refuse(name, 1, "column " + table.head[n] + "; expected a name of letters, digits and _");
      columns.groups.push_back(n);
      continue;
    }
    if (*at->second) refuse(name, 1, "fwhm and fwhm_mm both stand; expected one");
    *at->second = n;
  }
  if (!columns.path) refuse(name, 1, "has no column path; expected the place of each study");
  return columns;
}

CohortStudy study_of(const TextTable::Row& row, const Columns& columns, const fs::path& folder,
                     const std::string& name) {
  const auto cell = [&](const std::optional<std::size_t>& column) { return column ? row.cells[*column] : ""; };
  CohortStudy study;
  const std::string path = cell(columns.path);
  if (path.empty()) refuse(name, row.line, "path is empty; expected the place of a study");
  study.path = folder / path;
  study.series = cell(columns.series);
  study.id = cell(columns.id);
  // Made of the words of the table, not of the place of the table: a cohort that is moved keeps its ids.
  if (study.id.empty()) study.id = short_hash(path + "\n" + study.series);
  if (!is_id(study.id))
    refuse(name, row.line, "id is " + study.id + "; expected 1 to 64 letters, digits, dots, - and _, no dot first");
  if (const std::string fwhm = cell(columns.fwhm); !fwhm.empty()) study.fwhm_mm = fwhm_of(fwhm, name, row.line);
  study.options = words_of(cell(columns.options));
  for (const std::size_t column : columns.groups) study.groups.push_back(row.cells[column]);
  return study;
}

TextTable table_of(const fs::path& file) {
  const std::string name = file.string(), ending = file.extension().string();
  if (ending != ".tsv" && ending != ".csv" && ending != ".jsonl")
    throw InputError(name + ": is no table of studies; expected a folder, or a name that ends in .tsv, .csv or .jsonl");
  const std::string text = io::text_of_file(file);
  return ending == ".tsv"   ? detail::parse_tsv(text, name)
         : ending == ".csv" ? detail::parse_csv(text, name)
                            : detail::parse_json_lines(text, name);
}

/// Whether a folder holds these files and nothing else.
bool is_all_of(const fs::path& folder, const std::vector<fs::path>& files) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!std::binary_search(files.begin(), files.end(), entry.path())) return false;
    ++count;
  }
  return count == files.size();
}

/// A folder of links to the files. Links that stand there point to the same files, for the id tells their place.
fs::path linked(const std::vector<fs::path>& files, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  for (std::size_t n = 0; !error && n < files.size(); ++n) {
    const fs::path link = folder / (std::to_string(n + 1) + ".dcm");
    if (fs::exists(fs::symlink_status(link))) fs::remove(link, error);
    if (!error) fs::create_symlink(fs::absolute(files[n]), link, error);
  }
  if (error) throw IoError(folder.string() + ": cannot make links to the files of a study: " + error.message());
  return folder;
}

}  // namespace

std::string short_hash(std::string_view text) { return io::sha256_of(text).substr(0, 12); }

StudyList read_study_list(const std::filesystem::path& file) {
  const std::string name = file.string();
  const TextTable table = table_of(file);
  if (table.head.empty()) throw InputError(name + ": is empty; expected a table with the column path");
  const Columns columns = columns_of(table, name);
  StudyList list;
  for (const std::size_t column : columns.groups) list.group_columns.push_back(table.head[column]);
  std::map<std::string, std::size_t> line_of;
  for (const TextTable::Row& row : table.rows) {
    list.studies.push_back(study_of(row, columns, file.parent_path(), name));
    const auto [at, is_new] = line_of.emplace(list.studies.back().id, row.line);
    if (!is_new)
      refuse(
          name, row.line,
          "id " + list.studies.back().id + " stands in line " + std::to_string(at->second) + " too; expected it once");
  }
  return list;
}

std::string study_list_text(const StudyList& list) {
  const bool has_options =
      std::any_of(list.studies.begin(), list.studies.end(), [](const CohortStudy& s) { return !s.options.empty(); });
  std::string text = "id\tpath\tseries\tfwhm_mm";
  if (has_options) text += "\toptions";
  for (const std::string& column : list.group_columns) text += "\t" + column;
  text += "\n";
  for (const CohortStudy& study : list.studies) {
    const std::string path = fs::absolute(study.path).lexically_normal().string();
    // A name with a tab or line break would become another name when the table is read.
    if (detail::tsv_cell(path) != path)
      throw InputError(path + ": holds a control character, which no table can; expected another name");
    std::string fwhm(32, '\0');
    const char* const end =
        study.fwhm_mm ? std::to_chars(fwhm.data(), fwhm.data() + fwhm.size(), *study.fwhm_mm).ptr : fwhm.data();
    fwhm.resize(end - fwhm.data());
    text += study.id + "\t" + path + "\t" + study.series + "\t" + fwhm;
    std::string options;
    for (const std::string& word : study.options) options += (options.empty() ? "" : " ") + word;
    if (has_options) text += "\t" + options;
    for (const std::string& group : study.groups) text += "\t" + group;
    text += "\n";
  }
  return text;
}

StudyList list_of(const io::StudySearch& found, const std::filesystem::path& folder,
                  const std::filesystem::path& links) {
  StudyList list;
  for (const io::StudySearch::Found& study : found.studies) {
    CohortStudy row;
    row.id = short_hash(study.files.front().lexically_relative(folder).string());
    std::vector<fs::path> files = study.files;
    std::sort(files.begin(), files.end());
    const fs::path home = files.front().parent_path();
    row.path = files.size() == 1 ? files.front() : is_all_of(home, files) ? home : linked(files, links / row.id);
    list.studies.push_back(std::move(row));
  }
  return list;
}

}  // namespace dynasurf::cohort
