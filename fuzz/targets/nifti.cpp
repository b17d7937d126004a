#include "dynasurf/io/detail/formats.hpp"

#include "input_files.hpp"
#include "stored_gzip.hpp"
#include "target.hpp"

namespace dynasurf::fuzz {
namespace {

bool reads_nifti(InputFiles& files, const std::filesystem::path& path) {
  return reads(files.folder(), [&] {
    const Study study = io::read_nifti(path);
    require(!study.gates.empty(), "a study has a gate");
    for (const Image& gate : study.gates) require(gate.values.size() == study.grid().size(), "every voxel has a value");
  });
}

}  // namespace

bool run_nifti(std::string_view bytes) {
  InputFiles files;
  return reads_nifti(files, files.add("a.nii", bytes));
}

/// What is no gzip is packed first: a mutation that broke the checksum would say nothing of what is inside.
bool run_nifti_gz(std::string_view bytes) {
  const std::string packed = bytes.starts_with("\x1f\x8b") ? std::string(bytes) : stored_gzip(bytes);
  InputFiles files;
  return reads_nifti(files, files.add("a.nii.gz", packed));
}

/// The header, 348 bytes, and what follows as the .img beside it.
bool run_nifti_pair(std::string_view bytes) {
  const std::string_view header = bytes.substr(0, 348), voxels = bytes.substr(header.size());
  InputFiles files;
  files.add("a.img", voxels);
  return reads_nifti(files, files.add("a.hdr", header));
}

}  // namespace dynasurf::fuzz
