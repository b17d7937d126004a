#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dynasurf::io {

/// Every result folder holds this file. It lists all others, so that a result can be told from a folder of the user's
/// and an untouched result from an edited one.
inline constexpr const char* manifest_name = "manifest.txt";

/// A file of a result folder as it was written.
struct ManifestEntry {
  std::string name;  ///< path below the folder, '/' between its parts; any bytes but control characters
  std::uint64_t bytes = 0;
  std::string sha256;  ///< 64 hexadecimal digits
};

/// A line that names the format, then one line a file, sorted by name: SHA-256, size in bytes, name. Throws IoError
/// for a name that a line cannot hold.
std::string manifest_text(std::vector<ManifestEntry> files);

/// The inverse, sorted by name. `where` names the file in errors. Throws InputError for anything that manifest_text
/// does not write: a line without its end, a name that is absolute, leaves the folder or stands twice.
std::vector<ManifestEntry> parse_manifest(std::string_view text, const std::string& where);

/// Content of the manifest of a folder that is not published yet.
std::string unfinished_manifest_text();

/// Reads manifest.txt of a folder. Throws IoError when there is none, InputError as above or beyond 64 MiB.
std::vector<ManifestEntry> read_manifest(const std::filesystem::path& folder);

/// Something in a folder that its manifest does not explain.
struct ForeignFile {
  std::string name;  ///< below the folder
  std::string why;   ///< completes "NAME ..."
};

/// The first entry (by name) of `folder` that is not, byte for byte, what its manifest lists; absent when the folder is
/// empty or holds nothing but published files. Files that are listed and missing do not count, nor do empty folders.
/// Symbolic links are foreign and never followed.
std::optional<ForeignFile> first_foreign_file(const std::filesystem::path& folder);

}  // namespace dynasurf::io
