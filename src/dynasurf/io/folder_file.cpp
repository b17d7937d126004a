#include "dynasurf/io/detail/folder_file.hpp"

#include <algorithm>
#include <system_error>

#include "dynasurf/core/error.hpp"

namespace dynasurf::io {

namespace fs = std::filesystem;

bool is_plain_file_name(std::string_view name) {
  constexpr std::size_t most_bytes = 200;
  const bool is_plain = std::none_of(name.begin(), name.end(),
                                     [](unsigned char c) { return c < 32 || c == 127 || c == '/' || c == '\\'; });
  return is_plain && !name.empty() && name.size() <= most_bytes && name != "." && name != "..";
}

std::filesystem::path file_inside(const fs::path& folder, const fs::path& file) {
  fs::path path = folder / file;
  std::error_code error;
  fs::path home = fs::weakly_canonical(folder, error);
  if (!home.has_filename()) home = home.parent_path();  // a slash at the end of what is not there
  const fs::path real = error ? fs::path() : fs::weakly_canonical(path, error);
  if (error) throw InputError(path.string() + ": cannot be looked up: " + error.message());
  const auto [at_home, at_real] = std::mismatch(home.begin(), home.end(), real.begin(), real.end());
  if (file.is_absolute() || at_home != home.end() || at_real == real.end())
    throw InputError(path.string() + ": leads out of its folder; expected a file inside");
  return path;
}

}  // namespace dynasurf::io
