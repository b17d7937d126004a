#include "dynasurf/io/detail/atomic_file.hpp"

#include <functional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/manifest.hpp"
#include "dynasurf/io/study_io.hpp"

#include "support/mutations.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::io {
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
  for (const char* name : {"results.json", "meshes/a.ply", "meshes/b.ply"})
    write_file(folder / name, std::string(50000, letter));
}

void publish(const fs::path& place, char letter, Existing existing = Existing::replace) {
  OutputFolder folder(place, existing);
  fill(folder.path(), letter);
  folder.publish();
}

template <class Error, class Work>
std::string error_of(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
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

TEST(WriteFile, TakesThePlaceOfNothingButAFile) {
  const ScratchFolder scratch;
  ASSERT_EQ(::mkfifo((scratch / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(write_file(scratch / "pipe", "x"), IoError);
  EXPECT_TRUE(fs::is_fifo(scratch / "pipe"));
  EXPECT_THROW(write_file("/dev/null", "x"), IoError);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(OutputFile, KeepsAFormerFileWhereItIsAskedTo) {
  const ScratchFolder scratch;
  write_bytes(scratch / "wall.vtu", "mine");
  EXPECT_THROW(OutputFile(scratch / "wall.vtu", Existing::refuse), IoError);
  OutputFile file(scratch / "wall.vtu", Existing::move_aside);
  write_file(file.path(), "new");
  file.publish();
  EXPECT_EQ(read_bytes(scratch / "wall.vtu"), "new");
  EXPECT_EQ(file.moved_to(), scratch / "wall.vtu.old-1");
  EXPECT_EQ(read_bytes(scratch / "wall.vtu.old-1"), "mine");
}

TEST(OutputFile, TakesNoPlaceThatWasTakenMeanwhile) {
  const ScratchFolder scratch;
  {
    OutputFile file(scratch / "wall.vtu", Existing::refuse);
    write_file(file.path(), "new");
    write_bytes(scratch / "wall.vtu", "mine");
    EXPECT_THROW(file.publish(), IoError);
  }
  EXPECT_EQ(read_bytes(scratch / "wall.vtu"), "mine");
  EXPECT_EQ(names_in(scratch.path()), std::set<std::string>{"wall.vtu"});
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
    OutputFolder folder(scratch / "deep/deeper/result/");
    fill(folder.path(), 'a');
  }
  EXPECT_EQ(names_in(scratch.path()), std::set<std::string>{});
}

TEST(OutputFolder, ListsWhatItHolds) {
  const ScratchFolder scratch;
  {
    OutputFolder folder(scratch / "result");
    fill(folder.path(), 'a');
    write_bytes(folder.path() / "by another writer.txt", "abc");
    folder.publish();
  }
  const std::vector<ManifestEntry> files = read_manifest(scratch / "result");
  ASSERT_EQ(files.size(), 4u);
  EXPECT_EQ(files[0].name, "by another writer.txt");
  EXPECT_EQ(files[0].bytes, 3u);
  EXPECT_EQ(files[0].sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(files[1].name, "meshes/a.ply");
  EXPECT_EQ(files[1].sha256, sha256_of_file(scratch / "result/meshes/a.ply"));
  EXPECT_FALSE(first_foreign_file(scratch / "result"));
}

TEST(OutputFolder, ReplacesUntouchedResultsAndEmptyFoldersOnly) {
  const ScratchFolder scratch;
  fs::create_directory(scratch / "empty");
  for (const char letter : {'a', 'b', 'c'}) {
    publish(scratch / "empty", letter);
    EXPECT_EQ(letter_of(scratch / "empty"), letter);
  }
  fs::remove(scratch / "empty/meshes/a.ply");
  publish(scratch / "empty", 'd');
  EXPECT_EQ(letter_of(scratch / "empty"), 'd') << "a result of which something was taken is still only a result";
  write_bytes(scratch / "file", "x");
  EXPECT_THROW(OutputFolder(scratch / "file"), IoError);
  EXPECT_THROW(OutputFolder(scratch / "file", Existing::move_aside), IoError);
  EXPECT_EQ(names_in(scratch.path()), (std::set<std::string>{"empty", "file"}));
}

TEST(OutputFolder, KeepsEveryFolderThatHoldsSomethingElse) {
  const std::pair<const char*, std::function<void(const fs::path&)>> touches[] = {
      {"letter.txt", [](const fs::path& f) { write_bytes(f / "letter.txt", "dear"); }},
      {"meshes/scan.ply", [](const fs::path& f) { write_bytes(f / "meshes/scan.ply", "points"); }},
      {"results.json", [](const fs::path& f) { write_bytes(f / "results.json", std::string(50000, 'z')); }},
      {"meshes/b.ply", [](const fs::path& f) { write_bytes(f / "meshes/b.ply", "shorter"); }},
      {"link", [](const fs::path& f) { fs::create_symlink("results.json", f / "link"); }},
      {"manifest.txt", [](const fs::path& f) { write_bytes(f / "manifest.txt", "my own list"); }},
      {"results.json", [](const fs::path& f) { fs::remove(f / "manifest.txt"), fs::remove_all(f / "meshes"); }},
      {"meshes/a.ply",
       [](const fs::path& f) { fs::remove(f / "meshes/a.ply"), fs::create_symlink("b.ply", f / "meshes/a.ply"); }},
  };
  for (const auto& [name, touch] : touches) {
    const ScratchFolder scratch;
    publish(scratch / "result", 'a');
    touch(scratch / "result");
    const std::set<std::string> before = names_in(scratch / "result");
    const std::string error = error_of<IoError>([&] { publish(scratch / "result", 'b'); });
    EXPECT_THAT(error, testing::HasSubstr("for " + std::string(name) + " in it")) << error;
    EXPECT_EQ(names_in(scratch / "result"), before);
    EXPECT_EQ(names_in(scratch.path()), std::set<std::string>{"result"});
  }
}

TEST(OutputFolder, MovesAsideWhateverItIsAskedTo) {
  const ScratchFolder scratch;
  for (int round = 1; round <= 3; ++round) {
    fs::create_directories(scratch / "result");
    write_bytes(scratch / "result/letter.txt", std::to_string(round));
    OutputFolder folder(scratch / "result", Existing::move_aside);
    fill(folder.path(), 'a');
    folder.publish();
    const std::string beside = "result.old-" + std::to_string(round);
    EXPECT_EQ(folder.moved_to(), scratch / beside);
    EXPECT_EQ(read_bytes(scratch / beside / "letter.txt"), std::to_string(round));
    EXPECT_EQ(letter_of(scratch / "result"), 'a');
    EXPECT_FALSE(first_foreign_file(scratch / "result"));
  }
  EXPECT_EQ(names_in(scratch.path()),
            (std::set<std::string>{"result", "result.old-1", "result.old-2", "result.old-3"}));
}

TEST(OutputFolder, KeepsWhatAppearsWhileItIsFilled) {
  const std::function<void(const fs::path&)> appearances[] = {
      [](const fs::path& f) { fs::create_directory(f), write_bytes(f / "precious.txt", "mine"); },
      [](const fs::path& f) { write_bytes(f, "mine"); },
      [](const fs::path& f) { fs::create_symlink("elsewhere", f); },
  };
  for (const auto& appear : appearances) {
    const ScratchFolder scratch;
    {
      OutputFolder folder(scratch / "result");
      fill(folder.path(), 'a');
      appear(scratch / "result");
      EXPECT_THROW(folder.publish(), IoError);
    }
    const fs::path there = scratch / "result";
    EXPECT_TRUE(fs::is_symlink(there) ||
                read_bytes(fs::is_directory(there) ? there / "precious.txt" : there) == "mine");
    EXPECT_EQ(names_in(scratch.path()), std::set<std::string>{"result"});
  }
}

TEST(OutputFolder, KeepsAFormerResultThatIsTouchedWhileTheNewOneIsMade) {
  const ScratchFolder scratch;
  publish(scratch / "result", 'a');
  {
    OutputFolder folder(scratch / "result");
    fill(folder.path(), 'b');
    write_bytes(scratch / "result/notes.txt", "seen by me");
    EXPECT_THAT(error_of<IoError>([&] { folder.publish(); }), testing::HasSubstr("notes.txt"));
  }
  EXPECT_EQ(letter_of(scratch / "result"), 'a');
  EXPECT_EQ(read_bytes(scratch / "result/notes.txt"), "seen by me");
  EXPECT_EQ(names_in(scratch.path()), std::set<std::string>{"result"});
}

TEST(OutputFolder, RefusesToHoldItsInputs) {
  const ScratchFolder scratch;
  fs::create_directories(scratch / "data/scans");
  write_bytes(scratch / "data/scans/a.ply", "x");
  fs::create_symlink("data", scratch / "link");
  for (const char* out : {"data", "data/scans", "data/scans/", "link", "data/scans/a.ply"})
    for (const char* input : {"data/scans/a.ply", "link/scans/a.ply", "data/../data/scans/a.ply"})
      EXPECT_THROW(OutputFolder(scratch / out, Existing::move_aside, {scratch / input}), OptionError) << out;
  EXPECT_NO_THROW(OutputFolder(scratch / "data/result", Existing::replace, {scratch / "data/scans/a.ply"}));
}

TEST(OutputFolder, PublishesNothingWhenSomethingOfItIsGone) {
  const ScratchFolder scratch;
  publish(scratch / "result", 'a');
  {
    OutputFolder folder(scratch / "result");
    fill(folder.path(), 'b');
    fs::remove(folder.path() / "meshes/a.ply");
    EXPECT_THAT(error_of<IoError>([&] { folder.publish(); }), testing::HasSubstr("meshes/a.ply: has vanished"));
  }
  {
    OutputFolder folder(scratch / "result");
    fill(folder.path(), 'b');
    write_bytes(folder.path() / "meshes/a.ply", "b");
    EXPECT_THAT(error_of<IoError>([&] { folder.publish(); }), testing::HasSubstr("meshes/a.ply: was changed"));
  }
  {
    OutputFolder folder(scratch / "result");
    write_file(folder.path() / "results.json", "b");
    fs::remove_all(folder.path());
    EXPECT_THROW(write_file(folder.path() / "meshes/a.ply", "b"), IoError);
    EXPECT_FALSE(fs::exists(folder.path())) << "a folder that is gone must not be made anew: it would be torn";
    EXPECT_THROW(folder.publish(), IoError);
  }
  EXPECT_EQ(letter_of(scratch / "result"), 'a');
}

TEST(OutputFolder, RefusesAMountPoint) {
  const ScratchFolder scratch;
  const TinyDisk disk(scratch / "disk");
  if (!disk.mounted) GTEST_SKIP() << "this user may not mount a file system in memory";
  EXPECT_THAT(error_of<IoError>([&] { OutputFolder(scratch / "disk"); }), testing::HasSubstr("mount point"));
}

/// Runs `work` in a process of its own, in which renameat2 knows no flags, as on network file systems.
void without_exchange(const std::function<void()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    sock_filter program[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_renameat2, 0, 3),
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args[4])),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0, 1, 0),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EINVAL),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    const sock_fprog filter{std::size(program), program};
    if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) != 0)
      ::_exit(9);
    work();
    ::_exit(testing::Test::HasFailure() ? 1 : 0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 9) GTEST_SKIP() << "system calls cannot be refused here";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(OutputFolder, NeverLeavesAMomentWithoutAResultWhereFoldersCannotBeExchanged) {
  const ScratchFolder scratch;
  without_exchange([&] {
    publish(scratch / "result", 'a');
    EXPECT_EQ(letter_of(scratch / "result"), 'a');
    EXPECT_THAT(error_of<IoError>([&] { publish(scratch / "result", 'b'); }), testing::HasSubstr("cannot exchange"));
    EXPECT_EQ(letter_of(scratch / "result"), 'a');
    publish(scratch / "result", 'b', Existing::move_aside);
    EXPECT_EQ(letter_of(scratch / "result"), 'b');
    EXPECT_EQ(letter_of(scratch / "result.old-1"), 'a');
    OutputFile file(scratch / "wall.vtu", Existing::refuse);
    write_file(file.path(), "new");
    write_bytes(scratch / "wall.vtu", "mine");
    EXPECT_THROW(file.publish(), IoError);
    EXPECT_EQ(read_bytes(scratch / "wall.vtu"), "mine");
  });
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

/// The folder that another process has begun to fill beside `place`.
fs::path partial_beside(const fs::path& place) {
  for (const auto& entry : fs::directory_iterator(place.parent_path()))
    if (entry.path().filename().string().starts_with("." + place.filename().string() + ".partial-"))
      return entry.path();
  return {};
}

TEST(OutputFolder, LeavesAloneWhatALivingProcessFills) {
  const ScratchFolder scratch;
  int to_child[2], to_parent[2];
  ASSERT_EQ(::pipe(to_child), 0);
  ASSERT_EQ(::pipe(to_parent), 0);
  const pid_t child = ::fork();
  char byte = 'x';
  if (child == 0) {
    OutputFolder folder(scratch / "result");
    write_file(folder.path() / "results.json", std::string(50000, 'a'));
    if (::write(to_parent[1], &byte, 1) != 1 || ::read(to_child[0], &byte, 1) != 1) ::_exit(1);
    fill(folder.path(), 'a');
    folder.publish();
    ::_exit(0);
  }
  ASSERT_EQ(::read(to_parent[0], &byte, 1), 1);
  const fs::path partial = partial_beside(scratch / "result");
  ASSERT_FALSE(partial.empty());
  publish(scratch / "result", 'b');
  EXPECT_TRUE(fs::exists(partial / "results.json")) << "its lock says that it is in use";
  ASSERT_EQ(::write(to_child[1], &byte, 1), 1);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(letter_of(scratch / "result"), 'a');
  EXPECT_EQ(names_in(scratch.path()), std::set<std::string>{"result"});
}

TEST(OutputFolder, SweepsWhatTheDeadLeftAndKeepsWhatIsNotTheirs) {
  const ScratchFolder scratch;
  publish(scratch / "former", 'a');  // of a process that died between the exchange and the removal
  fs::rename(scratch / "former", scratch / ".result.partial-0123456789abcdef");
  fs::create_directory(scratch / ".result.partial-00000000000000ab");
  publish(scratch / "cut", 'a');  // of one that died within the removal
  fs::remove_all(scratch / "cut/meshes");
  fs::rename(scratch / "cut", scratch / ".result.partial-00000000000000cd");
  fs::create_directory(scratch / ".result.partial-00000000000000ef");
  write_bytes(scratch / ".result.partial-00000000000000ef/precious.txt", "mine");
  fs::create_directory(scratch / ".result.partial-backup");
  { OutputFolder folder(scratch / "result"); }
  EXPECT_EQ(names_in(scratch.path()), (std::set<std::string>{".result.partial-backup", "result.old-1"}));
  EXPECT_EQ(read_bytes(scratch / "result.old-1/precious.txt"), "mine");
}

TEST(DiscardUnpublished, RemovesWhatIsNotPublishedAndLetsNothingFollow) {
  const ScratchFolder scratch;
  publish(scratch / "result", 'a');
  const pid_t child = ::fork();  // it cannot be undone
  if (child == 0) {
    OutputFolder folder(scratch / "result");
    OutputFile file(scratch / "file");
    fill(folder.path(), 'b');
    discard_unpublished();
    bool refused = false;
    try {
      folder.publish();
    } catch (const std::runtime_error&) {
      refused = true;
    }
    ::_exit(refused && names_in(scratch.path()) == std::set<std::string>{"result"} ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(letter_of(scratch / "result"), 'a');
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
}  // namespace dynasurf::io
