#include "dynasurf/io/detail/formats.hpp"

#include "input_files.hpp"
#include "target.hpp"

namespace dynasurf::fuzz {
namespace {

bool reads_dicom(InputFiles& files, const std::filesystem::path& path, const std::string& series = {}) {
  return reads(files.folder(), [&] {
    const Study study = io::read_dicom(path, series);
    require(!study.gates.empty(), "a study has a gate");
    for (const Image& gate : study.gates) require(gate.values.size() == study.grid().size(), "every voxel has a value");
    io::dicom_facts(path, series);
  });
}

}  // namespace

bool run_dicom(std::string_view bytes) {
  InputFiles files;
  return reads_dicom(files, files.add("a.dcm", bytes));
}

/// Up to eight files of one folder; "--CUT--" stands between them.
bool run_dicom_folder(std::string_view bytes) {
  constexpr std::string_view border = "--CUT--";
  InputFiles files;
  for (char name = 'a'; name <= 'h'; ++name) {
    const std::size_t end = bytes.find(border);
    files.add(std::string(1, name) + ".dcm", bytes.substr(0, end));
    if (end == std::string_view::npos) break;
    bytes.remove_prefix(end + border.size());
  }
  const bool whole = reads_dicom(files, files.folder());
  const bool chosen = reads_dicom(files, files.folder(), "1");
  return whole || chosen;
}

}  // namespace dynasurf::fuzz
