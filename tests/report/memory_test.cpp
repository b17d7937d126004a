#include <algorithm>
#include <cstdlib>
#include <exception>
#include <functional>
#include <new>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/report/report.hpp"

#include "support/sample_meshes.hpp"
#include "support/sample_result.hpp"
#include "support/scratch_folder.hpp"

namespace {
/// How many allocations of this thread go well before one fails; negative: all do.
thread_local long left = -1;
}  // namespace

// Not inlined: the compiler would take free() for the wrong end of new.
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (left >= 0 && left-- == 0) throw std::bad_alloc();
  if (void* const block = std::malloc(std::max<std::size_t>(size, 1))) return block;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return left >= 0 && left-- == 0 ? nullptr : std::malloc(std::max<std::size_t>(size, 1));
}
[[gnu::noinline]] void operator delete(void* block) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void* block, std::size_t) noexcept { std::free(block); }

namespace dynasurf::report {
namespace {

enum class End { done, told, other };

/// How a process ends whose allocation number `at` fails while it works.
End end_of(long at, const std::function<void()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    // The end of a nlohmann::json takes memory too and cannot throw. The program tells that by a handler of its own.
    std::set_terminate([] { _exit(1); });
    left = at;
    try {
      work();
    } catch (const std::bad_alloc&) {
      _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (!WIFEXITED(status)) return End::other;
  return WEXITSTATUS(status) == 0 ? End::done : End::told;
}

/// Every `stride`-th allocation of the work fails: each time it tells so. Gives the number of its allocations.
long failures_of(const std::function<void()>& work, long stride = 1) {
  for (long at = 0;; at += stride) {
    const End end = end_of(at, work);
    EXPECT_NE(end, End::other) << "allocation " << at;
    if (end != End::told) return at;
  }
}

Provenance provenance() {
  return {.program_version = "1", .commit = "2", .command = "", .inputs = {}, .options_json = "{}", .seed = {}};
}

// A null value of nlohmann::json that becomes an object or an array by its first member holds no memory for it when
// that fails, and its end then reads through a null pointer. Whoever fills one starts from an empty object or array.
TEST(Memory, MayFailAnywhereInTheResults) {
  const ventricle::Result result = test::sample_result({.gates = 2, .dims = {8, 8, 8}, .mesh_level = 1});
  EXPECT_GT(failures_of([&] { results_json(result, provenance()); }), 500);
}

TEST(Memory, MayFailAnywhereInThePage) {
  const ventricle::Result result = test::sample_result({.gates = 2, .dims = {8, 8, 8}, .mesh_level = 1});
  EXPECT_GT(failures_of([&] { report_html(result, provenance()); }, 7), 1000);
}

TEST(Memory, MayFailAnywhereInABinaryGltfFile) {
  const test::ScratchFolder folder;
  const std::vector<io::AnimatedSurface> beating{{"endo", {1, 0, 0, 0.5F}, test::beating_ball(1, 3)}};
  EXPECT_GT(failures_of([&] { io::write_glb(beating, 1, folder / "a.glb"); }), 100);
  std::vector<io::LodSurface> levels(2);
  for (io::LodSurface& level : levels) level.name = "level", level.mesh = test::lopsided_ball(1);
  EXPECT_GT(failures_of([&] { io::write_lod_glb(levels, folder / "b.glb"); }), 100);
  EXPECT_GT(failures_of([&] { io::write_packed_lod_glb(levels, folder / "c.glb"); }), 100);
}

}  // namespace
}  // namespace dynasurf::report
