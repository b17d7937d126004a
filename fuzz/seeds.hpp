#pragma once
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace dynasurf::fuzz {

/// Where the seeds of a target are written, one file each.
class SeedFolder {
 public:
  SeedFolder(const std::filesystem::path& all, const std::string& target) : folder_(all / target) {
    std::filesystem::create_directories(folder_);
  }
  void add(std::string_view bytes) {
    const std::string name = "seed-" + std::to_string(count_++) + ".bin";
    std::ofstream(folder_ / name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }

 private:
  std::filesystem::path folder_;
  int count_ = 0;
};

void write_text_seeds(const std::filesystem::path& all);
void write_mesh_seeds(const std::filesystem::path& all);
void write_manifest_seeds(const std::filesystem::path& all);
void write_option_seeds(const std::filesystem::path& all);

}  // namespace dynasurf::fuzz
