#include "dynasurf/io/detail/manifest.hpp"

#include <algorithm>
#include <charconv>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view headline = "dynasurf manifest 1: SHA-256, bytes and name of every file of this result\n";
constexpr std::string_view unfinished = "dynasurf manifest 1: not finished\n";
constexpr std::size_t hash_digits = 64;

bool is_control(char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }

/// Below the folder, without detours. Names come from a file that anybody may have edited: none may lead out of the
/// folder, or into a second line.
bool is_plain_name(std::string_view name) {
  if (name.empty() || std::any_of(name.begin(), name.end(), is_control)) return false;
  for (std::size_t from = 0; from <= name.size();) {
    const std::size_t to = std::min(name.find('/', from), name.size());
    const std::string_view part = name.substr(from, to - from);
    if (part.empty() || part == "." || part == "..") return false;
    from = to + 1;
  }
  return true;
}

bool is_hash(std::string_view text) {
  return text.size() == hash_digits &&
         std::all_of(text.begin(), text.end(), [](char c) { return ('0' <= c && c <= '9') || ('a' <= c && c <= 'f'); });
}

/// "HASH BYTES NAME"; absent when the line is anything else.
std::optional<ManifestEntry> parse_line(std::string_view line) {
  if (line.size() < hash_digits + 4 || line[hash_digits] != ' ' || !is_hash(line.substr(0, hash_digits))) return {};
  ManifestEntry entry;
  entry.sha256 = line.substr(0, hash_digits);
  const char *const size = line.data() + hash_digits + 1, *const end = line.data() + line.size();
  // A size has one spelling, without leading zeros: what manifest_text does not write is refused.
  const auto [rest, error] = std::from_chars(size, end, entry.bytes);
  if (error != std::errc{} || rest == end || *rest != ' ' || (*size == '0' && rest != size + 1)) return {};
  entry.name.assign(rest + 1, end);
  return is_plain_name(entry.name) ? std::optional(entry) : std::nullopt;
}

const ManifestEntry* find(const std::vector<ManifestEntry>& files, const std::string& name) {
  const auto at = std::lower_bound(files.begin(), files.end(), name,
                                   [](const ManifestEntry& file, const std::string& n) { return file.name < n; });
  return at != files.end() && at->name == name ? &*at : nullptr;
}

/// What a look at names and sizes tells; `listed` collects the files whose bytes have still to be compared.
void look(const fs::path& folder, const std::vector<ManifestEntry>& manifest, std::optional<ForeignFile>& first,
          std::vector<const ManifestEntry*>& listed) {
  const auto blame = [&](const std::string& name, const char* why) {
    if (!first || name < first->name) first = ForeignFile{name, why};
  };
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder).string();
    // The link itself, not what it leads to: what a result holds are plain files.
    const fs::file_status status = entry.symlink_status();
    if (fs::is_directory(status)) continue;
    const ManifestEntry* file = find(manifest, name);
    if (name == manifest_name && fs::is_regular_file(status)) continue;
    if (!file)
      blame(name, "is not listed in its manifest.txt");
    else if (!fs::is_regular_file(status))
      blame(name, "is no longer the file that was written");
    else if (entry.file_size() != file->bytes)
      blame(name, "was changed since it was written");
    else
      listed.push_back(file);
  }
}

}  // namespace

std::string manifest_text(std::vector<ManifestEntry> files) {
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  std::string text(headline);
  for (const ManifestEntry& file : files) {
    if (!is_plain_name(file.name)) throw IoError(file.name + ": cannot be listed in a manifest; expected a plain name");
    text += file.sha256 + " " + std::to_string(file.bytes) + " " + file.name + "\n";
  }
  return text;
}

std::string unfinished_manifest_text() { return std::string(unfinished); }

std::vector<ManifestEntry> parse_manifest(std::string_view text, const std::string& where) {
  if (!text.starts_with(headline)) throw InputError(where + ": is no manifest of this program");
  std::vector<ManifestEntry> files;
  for (std::size_t from = headline.size(), number = 2; from < text.size(); ++number) {
    const std::size_t to = text.find('\n', from);
    const auto blame = [&](const char* what) {
      throw InputError(where + ": line " + std::to_string(number) + " " + what);
    };
    if (to == std::string_view::npos) blame("has no end; the file was cut");
    const auto entry = parse_line(text.substr(from, to - from));
    if (!entry) blame("is not SHA-256, size and plain name of a file");
    if (!files.empty() && entry->name <= files.back().name) blame("names a file out of order");
    files.push_back(*entry);
    from = to + 1;
  }
  return files;
}

std::vector<ManifestEntry> read_manifest(const fs::path& folder) {
  const fs::path file = folder / manifest_name;
  return parse_manifest(text_of_file(file), file.string());
}

std::optional<ForeignFile> first_foreign_file(const fs::path& folder) {
  std::error_code ignored;
  const bool has_manifest = fs::is_regular_file(fs::symlink_status(folder / manifest_name, ignored));
  std::vector<ManifestEntry> manifest;
  if (has_manifest) try {
      manifest = read_manifest(folder);
    } catch (const std::runtime_error&) {
      return ForeignFile{manifest_name, "is not a manifest that this program wrote"};
    }
  std::optional<ForeignFile> first;
  std::vector<const ManifestEntry*> listed;
  try {
    look(folder, manifest, first, listed);
  } catch (const fs::filesystem_error& error) {
    return ForeignFile{error.path1().lexically_relative(folder).string(), "cannot be looked at"};
  }
  if (first && !has_manifest) first->why = "is not of a result: the folder has no manifest.txt";
  // Hashing costs most and comes last; files behind the first foreign name need none, because that name is the answer.
  for (const ManifestEntry* file : listed) {
    if (first && first->name < file->name) continue;
    try {
      if (sha256_of_file(folder / file->name) != file->sha256)
        first = ForeignFile{file->name, "was changed since it was written"};
    } catch (const IoError&) {
      first = ForeignFile{file->name, "cannot be read"};
    }
  }
  return first;
}

}  // namespace dynasurf::io
