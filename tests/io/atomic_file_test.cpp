#include "dynasurf/io/atomic_file.hpp"

#include <functional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/study_io.hpp"

#include "support/mutations.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf {
namespace {

namespace fs = std::filesystem;
using test::read_bytes;
using test::ScratchFolder;
using test::write_bytes;

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

void fill(const fs::path& folder, char letter) {
  fs::create_directory(folder / "meshes");
  for (const char* name : {"results.json", "meshes/a.ply", "meshes/b.ply"})
    write_bytes(folder / name, std::string(50000, letter));
}

/// The letter a result folder is filled with, '?' when it is torn, '-' when it is missing.
char letter_of(const fs::path& folder) {
  if (!fs::exists(folder)) return '-';
  char letter = 0;
  for (const char* name : {"results.json", "meshes/a.ply", "meshes/b.ply"}) {
    const std::string bytes = read_bytes(folder / name);
    if (bytes.empty() || bytes != std::string(50000, bytes[0]) || (letter && letter != bytes[0])) return '?';
    letter = bytes[0];
  }
  return letter;
}

/// A file system in memory that holds little; false when this user may not mount one.
struct TinyDisk {
  fs::path place;
  bool mounted;
  explicit TinyDisk(const fs::path& at)
      : place(at), mounted(fs::create_directory(at) && ::mount("tmpfs", at.c_str(), "tmpfs", 0, "size=128k") == 0) {}
  ~TinyDisk() {
    if (mounted) ::umount(place.c_str());
  }
};

TEST(WriteFile, WritesAndReplaces) {
  const ScratchFolder scratch;
  write_file(scratch / "a.txt", "one");
  EXPECT_EQ(read_bytes(scratch / "a.txt"), "one");
  write_file(scratch / "a.txt", "");
  EXPECT_EQ(read_bytes(scratch / "a.txt"), "");
  write_file(scratch / "new/deeper/a.txt", "two");
  EXPECT_EQ(read_bytes(scratch / "new/deeper/a.txt"), "two");
  EXPECT_EQ(names_in(scratch.path()), (std::set<std::string>{"a.txt", "new"}));
}

TEST(WriteFile, ReplacesTheTargetOfALinkAndNotTheLink) {
  const ScratchFolder scratch;
  write_bytes(scratch / "real.txt", "old");
  fs::create_symlink("real.txt", scratch / "link.txt");
  write_file(scratch / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(scratch / "link.txt"));
  EXPECT_EQ(read_bytes(scratch / "real.txt"), "new");
}

TEST(WriteFile, RefusesPlacesThatCannotBeFiles) {
  const ScratchFolder scratch;
  write_bytes(scratch / "file", "x");
  EXPECT_THROW(write_file(scratch.path(), "x"), IoError);
  EXPECT_THROW(write_file(scratch / "file/below.txt", "x"), IoError);
  EXPECT_THROW(write_file("/proc/dynasurf.txt", "x"), IoError);
}

TEST(WriteFile, LeavesTheOldFileWhenTheDiskIsFull) {
  const ScratchFolder scratch;
  const TinyDisk disk(scratch / "disk");
  if (!disk.mounted) GTEST_SKIP() << "this user may not mount a file system in memory";
  write_file(scratch / "disk/a.txt", "old");
  EXPECT_THROW(write_file(scratch / "disk/a.txt", std::string(200000, 'n')), IoError);
  EXPECT_EQ(read_bytes(scratch / "disk/a.txt"), "old");
  EXPECT_EQ(names_in(scratch / "disk"), (std::set<std::string>{"a.txt"}));
}

TEST(WriteFile, LeavesTheOldFileAtTheLimitOfFileSize) {
  const ScratchFolder scratch;
  write_file(scratch / "a.txt", "old");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto former_handler = ::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(write_file(scratch / "a.txt", std::string(200000, 'n')), IoError);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  ::signal(SIGXFSZ, former_handler);
  EXPECT_EQ(read_bytes(scratch / "a.txt"), "old");
  EXPECT_EQ(names_in(scratch.path()), (std::set<std::string>{"a.txt"}));
}

/// Runs `work` in a child process over and over. Kills it `microseconds` after it has finished `rounds` of them: on a
/// busy machine time alone would kill it before it has done anything.
void kill_in_the_middle_of(const std::function<void()>& work, std::uint64_t rounds, std::uint64_t microseconds) {
  int pipe_ends[2];
  ASSERT_EQ(::pipe(pipe_ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      while (true) {
        work();
        if (::write(pipe_ends[1], "x", 1) != 1) ::_exit(8);
      }
    } catch (...) {
      ::_exit(7);
    }
  }
  ASSERT_GT(child, 0);
  ::close(pipe_ends[1]);
  char finished = 0;
  for (; rounds > 0; --rounds)
    if (::read(pipe_ends[0], &finished, 1) != 1) break;
  ::usleep(static_cast<useconds_t>(microseconds));
  ::kill(child, SIGKILL);
  ::close(pipe_ends[0]);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status)) << "the child ended by itself: a write failed";
}

TEST(WriteFile, IsOldOrNewButNeverTornWhenKilled) {
  const ScratchFolder scratch;
  const fs::path path = scratch / "a.bin";
  write_file(path, std::string(300000, 'a'));
  test::Dice dice{42};
  std::set<char> seen;
  for (int round = 0; round < 200; ++round) {
    char letter = 'a';
    kill_in_the_middle_of([&] { write_file(path, std::string(300000, letter = letter == 'a' ? 'b' : 'a')); }, dice(3),
                          dice(2000));
    const std::string bytes = read_bytes(path);
    ASSERT_EQ(bytes.size(), 300000u);
    ASSERT_EQ(bytes, std::string(300000, bytes[0]));
    seen.insert(bytes[0]);
  }
  EXPECT_EQ(seen.size(), 2u) << "the kills never came between two writes; they tested nothing";
  write_file(path, "after");
  EXPECT_EQ(names_in(scratch.path()), (std::set<std::string>{"a.bin"})) << "leftovers of the dead are not cleaned up";
}

TEST(OutputFolder, AppearsOnlyWhenPublished) {
  const ScratchFolder scratch;
  {
    OutputFolder folder(scratch / "result");
    fill(folder.path(), 'a');
    EXPECT_EQ(letter_of(scratch / "result"), '-');
    EXPECT_EQ(folder.path().parent_path(), scratch.path()) << "a rename cannot cross file systems";
    folder.publish();
    EXPECT_EQ(letter_of(scratch / "result"), 'a');
  }
  EXPECT_EQ(names_in(scratch.path()), (std::set<std::string>{"result"}));
}

TEST(OutputFolder, LeavesNothingWhenItIsNotPublished) {
  const ScratchFolder scratch;
  {
    OutputFolder folder(scratch / "deep/result/");
    fill(folder.path(), 'a');
  }
  EXPECT_EQ(names_in(scratch / "deep"), std::set<std::string>{});
}

TEST(OutputFolder, ReplacesAFormerResultOnly) {
  const ScratchFolder scratch;
  fs::create_directory(scratch / "empty");
  fs::create_directory(scratch / "home");
  write_bytes(scratch / "home/letter.txt", "dear");
  write_bytes(scratch / "file", "x");
  for (const char letter : {'a', 'b', 'c'}) {
    OutputFolder folder(scratch / "empty");
    fill(folder.path(), letter);
    folder.publish();
    EXPECT_EQ(letter_of(scratch / "empty"), letter);
  }
  EXPECT_THROW(OutputFolder(scratch / "home"), IoError);
  EXPECT_THROW(OutputFolder(scratch / "file"), IoError);
  EXPECT_THROW(OutputFolder(scratch / "file", true), IoError);
  EXPECT_EQ(read_bytes(scratch / "home/letter.txt"), "dear");
  {
    OutputFolder folder(scratch / "home", true);
    fill(folder.path(), 'a');
    folder.publish();
  }
  EXPECT_EQ(letter_of(scratch / "home"), 'a');
  EXPECT_FALSE(fs::exists(scratch / "home/letter.txt"));
  EXPECT_EQ(names_in(scratch.path()), (std::set<std::string>{"empty", "file", "home"}));
}

TEST(OutputFolder, IsOldOrNewButNeverTornOrMissingWhenKilled) {
  const ScratchFolder scratch;
  {
    OutputFolder folder(scratch / "result");
    fill(folder.path(), 'a');
    folder.publish();
  }
  test::Dice dice{43};
  std::set<char> seen;
  for (int round = 0; round < 200; ++round) {
    char letter = 'a';
    kill_in_the_middle_of(
        [&] {
          OutputFolder folder(scratch / "result");
          fill(folder.path(), letter = letter == 'a' ? 'b' : 'a');
          folder.publish();
        },
        dice(3), dice(2000));
    const char found = letter_of(scratch / "result");
    ASSERT_TRUE(found == 'a' || found == 'b') << found;
    seen.insert(found);
  }
  EXPECT_EQ(seen.size(), 2u) << "the kills never came between two results; they tested nothing";
  { OutputFolder folder(scratch / "result"); }
  EXPECT_EQ(names_in(scratch.path()), (std::set<std::string>{"result"})) << "leftovers of the dead are not cleaned up";
}

TEST(OutputFolder, PutsBackAResultThatADeadProcessHadMovedAside) {
  const ScratchFolder scratch;
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  int status = 0;
  ::waitpid(child, &status, 0);  // from here on the number names nobody
  const fs::path aside = scratch / (".result.former-" + std::to_string(child) + ".0");
  fs::create_directory(aside);
  fill(aside, 'a');
  fs::create_directory(scratch / (".result.partial-" + std::to_string(child) + ".1"));
  fs::create_directory(scratch / (".result.partial-" + std::to_string(::getppid()) + ".1"));
  { OutputFolder folder(scratch / "result"); }
  EXPECT_EQ(letter_of(scratch / "result"), 'a');
  EXPECT_EQ(names_in(scratch.path()),
            (std::set<std::string>{"result", ".result.partial-" + std::to_string(::getppid()) + ".1"}))
      << "what a living process writes is not ours to remove";
}

TEST(OutputFolder, LeavesTheOldResultWhenTheDiskIsFull) {
  const ScratchFolder scratch;
  const TinyDisk disk(scratch / "disk");
  if (!disk.mounted) GTEST_SKIP() << "this user may not mount a file system in memory";
  {
    OutputFolder folder(scratch / "disk/result");
    write_file(folder.path() / "results.json", "old");
    folder.publish();
  }
  EXPECT_THROW(
      {
        OutputFolder folder(scratch / "disk/result");
        write_file(folder.path() / "results.json", std::string(200000, 'n'));
        folder.publish();
      },
      IoError);
  EXPECT_EQ(read_bytes(scratch / "disk/result/results.json"), "old");
  EXPECT_EQ(names_in(scratch / "disk"), (std::set<std::string>{"result"}));
}

TEST(Sha256, OfAFileIsThePublishedOne) {
  const ScratchFolder scratch;
  write_bytes(scratch / "abc", "abc");
  EXPECT_EQ(sha256_of_file(scratch / "abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  write_bytes(scratch / "long", std::string(1000000, 'a'));
  EXPECT_EQ(sha256_of_file(scratch / "long"), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_THROW(sha256_of_file(scratch / "absent"), IoError);
}

}  // namespace
}  // namespace dynasurf
