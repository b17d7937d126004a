// Gives a target every file of a folder, one after the other, and says what came of it: fuzz_replay TARGET FILE...
// Ends with 1 where nothing was replayed or nothing was read: then the corpus or the target is broken, not the reader.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <signal.h>
#include <sys/time.h>

#include "target.hpp"

namespace {

namespace fs = std::filesystem;

constexpr int most_seconds = 1;  // of processor time, for one input

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// The process ends with SIGPROF, and the name of the input stands in its last line, unless this is set anew in time.
void start_clock(int seconds) {
  const itimerval limit{{0, 0}, {seconds, 0}};
  ::setitimer(ITIMER_PROF, &limit, nullptr);
}

std::vector<fs::path> inputs_of(int argc, char** argv) {
  std::vector<fs::path> inputs;
  for (int n = 2; n < argc; ++n) {
    if (!fs::is_directory(argv[n])) {
      inputs.emplace_back(argv[n]);
      continue;
    }
    for (const auto& entry : fs::directory_iterator(argv[n]))
      if (entry.is_regular_file()) inputs.push_back(entry.path());
  }
  std::sort(inputs.begin(), inputs.end());
  return inputs;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

int replay(const dynasurf::fuzz::Target& target, const std::vector<fs::path>& inputs) {
  std::size_t read = 0;
  double slowest = 0;
  for (const fs::path& path : inputs) {
    const std::string bytes = bytes_of(path);
    std::printf("%s ", path.filename().c_str());
    std::fflush(stdout);  // the last line tells which input ended the process
    const double start = processor_seconds();
    start_clock(most_seconds);
    const bool was_read = target.run(bytes);
    start_clock(0);
    const double seconds = processor_seconds() - start;
    std::printf("%s %.0f ms\n", was_read ? "read" : "refused", 1000 * seconds);
    read += was_read;
    slowest = std::max(slowest, seconds);
  }
  std::printf("%s: %zu inputs, %zu read, %zu refused, the slowest in %.0f ms\n", std::string(target.name).c_str(),
              inputs.size(), read, inputs.size() - read, 1000 * slowest);
  return read > 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string name = argc > 2 ? argv[1] : "";
  for (const dynasurf::fuzz::Target& target : dynasurf::fuzz::all_targets())
    if (target.name == name) return replay(target, inputs_of(argc, argv));
  std::fprintf(stderr, "usage: fuzz_replay TARGET FILE_OR_FOLDER...\ntargets:");
  for (const dynasurf::fuzz::Target& target : dynasurf::fuzz::all_targets())
    std::fprintf(stderr, " %s", std::string(target.name).c_str());
  std::fprintf(stderr, "\n");
  return 2;
}
