#pragma once
#include <filesystem>

namespace dynasurf::app {

/// A file or folder that goes away with everything in it when this goes out of scope, and also when the program ends
/// itself without unwinding. It need not exist yet. What cannot be removed stays without a word.
class RemovedAtEnd {
 public:
  explicit RemovedAtEnd(const std::filesystem::path& path);
  ~RemovedAtEnd();
  RemovedAtEnd(const RemovedAtEnd&) = delete;
  RemovedAtEnd& operator=(const RemovedAtEnd&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// For the moment before the program ends itself: removes what still has its RemovedAtEnd. Child programs that write
/// there must have been killed.
void remove_what_goes_at_end() noexcept;

}  // namespace dynasurf::app
