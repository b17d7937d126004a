#include "dynasurf/core/error.hpp"
#include "dynasurf/io/formats.hpp"
namespace dynasurf {
Study read_dicom(const std::filesystem::path& path) { throw InputError(path.string() + ": DICOM is not read yet"); }
std::vector<std::filesystem::path> files_of_dicom(const std::filesystem::path& path) { return {path}; }
}  // namespace dynasurf
