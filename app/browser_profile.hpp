#pragma once
#include <filesystem>
#include <memory>

namespace dynasurf::app {

/// A folder of its own for a browser's settings, which it would else look for at home; removed at the end. Those that
/// killed runs left are removed at the beginning.
class BrowserProfile {
 public:
  /// Throws IoError.
  BrowserProfile();
  ~BrowserProfile();
  const std::filesystem::path& path() const;

 private:
  struct Held;
  std::unique_ptr<Held> held_;
};

}  // namespace dynasurf::app
