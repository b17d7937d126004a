#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "input_files.hpp"

namespace dynasurf::fuzz {

InputFiles::InputFiles() {
  namespace fs = std::filesystem;
  // A file system in memory where there is one: half of the time of a run is spent here.
  const fs::path memory = "/dev/shm";
  std::error_code error;
  folder_ = ((fs::is_directory(memory, error) ? memory : fs::temp_directory_path()) / "dynasurf-fuzz-XXXXXX").string();
  if (::mkdtemp(folder_.data()) == nullptr) throw std::runtime_error("cannot make a folder for the input");
}

InputFiles::~InputFiles() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::filesystem::path InputFiles::add(const std::string& name, std::string_view bytes) {
  const std::filesystem::path path = std::filesystem::path(folder_) / name;
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return path;
}

}  // namespace dynasurf::fuzz
