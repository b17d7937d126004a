#include "input_names.hpp"

#include <algorithm>
#include <string_view>

namespace dynasurf::app {

std::string neutral_name(const std::filesystem::path& file, std::size_t position) {
  constexpr std::string_view known[] = {".dcm", ".nii", ".nii.gz", ".nrrd", ".nhdr", ".IMA", ".ima", ".ply", ".xyz",
                                        ".txt", ".asc", ".pts",    ".csv",  ".pwn",  ".obj", ".off", ".stl", ".las"};
  std::string ending = file.extension().string();
  if (ending == ".gz") ending = file.stem().extension().string() + ending;
  const bool is_known = std::find(std::begin(known), std::end(known), ending) != std::end(known);
  return "input-" + std::to_string(position + 1) + (is_known ? ending : "");
}

}  // namespace dynasurf::app
