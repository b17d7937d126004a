#include "dynasurf/io/detail/formats.hpp"

#include "input_files.hpp"
#include "stored_gzip.hpp"
#include "target.hpp"

namespace dynasurf::fuzz {
namespace {

bool reads_nrrd(InputFiles& files, const std::filesystem::path& path) {
  return reads(files.folder(), [&] {
    const Study study = io::read_nrrd(path);
    require(!study.gates.empty(), "a study has a gate");
    for (const Image& gate : study.gates) require(gate.values.size() == study.grid().size(), "every voxel has a value");
  });
}

/// Voxels of a header that calls them gzip, packed where they are not: a mutation would only break the checksum.
std::string packed_if_called_so(std::string_view header, std::string_view voxels) {
  const bool is_packed = voxels.starts_with("\x1f\x8b");
  return header.find("encoding: gz") == std::string_view::npos || is_packed ? std::string(voxels) : stored_gzip(voxels);
}

}  // namespace

bool run_nrrd(std::string_view bytes) {
  const std::size_t blank = bytes.find("\n\n");
  const std::string_view header = bytes.substr(0, blank == std::string_view::npos ? bytes.size() : blank + 2);
  const std::string file = std::string(header) + packed_if_called_so(header, bytes.substr(header.size()));
  InputFiles files;
  return reads_nrrd(files, files.add("a.nrrd", file));
}

/// A header and its voxels in a file of its own; a line "----" stands between them.
bool run_nhdr(std::string_view bytes) {
  constexpr std::string_view border = "----\n";
  const std::size_t end = bytes.find(border);
  const std::string_view header = bytes.substr(0, end);
  const std::string voxels = packed_if_called_so(
      header, end == std::string_view::npos ? std::string_view() : bytes.substr(end + border.size()));
  InputFiles files;
  files.add("a.raw", voxels);
  return reads_nrrd(files, files.add("a.nhdr", header));
}

}  // namespace dynasurf::fuzz
