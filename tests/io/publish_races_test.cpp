// What other runs do between the exchange of a new result for the former one and the look at what came back. The call
// that exchanges is replaced in this program: after it, the other run has its turn, and is waited for.
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdio.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"

#include "support/scratch_folder.hpp"

namespace {

/// Called with the first path of an exchange that was made, at which the former result then stands.
std::function<void(const std::filesystem::path&)> after_exchange;

}  // namespace

extern "C" int renameat2(int from, const char* path, int to, const char* other, unsigned int flags) noexcept {
  const int result = static_cast<int>(::syscall(SYS_renameat2, from, path, to, other, flags));
  const bool is_staged = std::filesystem::path(path).filename().string().starts_with(".result.partial-");
  if (result == 0 && flags == RENAME_EXCHANGE && is_staged && after_exchange) after_exchange(path);
  return result;
}

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;
using test::read_bytes;
using test::ScratchFolder;
using test::write_bytes;

void publish(const fs::path& place, const std::string& content) {
  OutputFolder folder(place);
  for (const char* name : {"a.txt", "meshes/b.txt"}) write_file(folder.path() / name, content);
  folder.publish();
}

/// "torn" when the files of the folder do not belong together.
std::string content_of(const fs::path& folder) {
  const std::string content = read_bytes(folder / "a.txt");
  return read_bytes(folder / "meshes/b.txt") == content ? content : "torn";
}

/// Another process, which does its work when it is told to.
class OtherRun {
 public:
  explicit OtherRun(const std::function<void()>& work) {
    if (::pipe(begin_) != 0 || ::pipe(end_) != 0) throw std::runtime_error("no pipes");
    process_ = ::fork();
    if (process_ != 0) return;
    char byte = 'x';
    if (::read(begin_[0], &byte, 1) != 1) ::_exit(1);
    try {
      work();
    } catch (const std::exception&) {
      byte = 'e';
    }
    ::_exit(::write(end_[1], &byte, 1) == 1 && byte == 'x' ? 0 : 2);
  }

  /// Whether its work ended within `wait_ms`.
  bool work(int wait_ms) {
    const char byte = 'x';
    EXPECT_EQ(::write(begin_[1], &byte, 1), 1);
    pollfd end{end_[0], POLLIN, 0};
    return ::poll(&end, 1, wait_ms) == 1;
  }

  /// The code it exits with, 2 after an exception.
  int wait() const {
    int status = 0;
    ::waitpid(process_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  int begin_[2], end_[2];
  pid_t process_ = -1;
};

constexpr int long_ms = 60000;
constexpr int moment_ms = 300;  // for what is not to happen: a slow machine makes the test pass, not fail

class PublishRace : public testing::Test {
 protected:
  ~PublishRace() override { after_exchange = nullptr; }

  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(scratch_.path())) found.push_back(entry.path().filename().string());
    return found;
  }

  const ScratchFolder scratch_;
  const fs::path place_ = scratch_ / "result";
};

TEST_F(PublishRace, KeepsTheFormerResultFromSweepersUntilItIsLookedAt) {
  publish(place_, "former");
  OtherRun sweeper([&] { OutputFolder folder(place_); });
  after_exchange = [&](const fs::path& former) {
    after_exchange = nullptr;
    EXPECT_TRUE(sweeper.work(long_ms));
    EXPECT_EQ(content_of(former), "former") << "was swept away before it was looked at";
  };
  publish(place_, "new");
  EXPECT_EQ(content_of(place_), "new");
  EXPECT_EQ(sweeper.wait(), 0);
  EXPECT_THAT(names(), testing::ElementsAre("result"));
}

TEST_F(PublishRace, PutsBackWhatIsNotItsOwnThoughAnotherRunSweeps) {
  publish(place_, "former");
  OtherRun sweeper([&] { OutputFolder folder(place_); });
  after_exchange = [&](const fs::path& former) {
    after_exchange = nullptr;
    EXPECT_TRUE(sweeper.work(long_ms));
    EXPECT_EQ(read_bytes(former / "notes.txt"), "mine");
  };
  {
    OutputFolder folder(place_);
    write_file(folder.path() / "a.txt", "new");
    write_bytes(place_ / "notes.txt", "mine");
    EXPECT_THROW(folder.publish(), IoError);
  }
  EXPECT_EQ(content_of(place_), "former");
  EXPECT_EQ(read_bytes(place_ / "notes.txt"), "mine");
  EXPECT_EQ(sweeper.wait(), 0);
  EXPECT_THAT(names(), testing::ElementsAre("result"));
}

TEST_F(PublishRace, PutsBackAFolderWithoutAManifestThoughAnotherRunSweeps) {
  OtherRun sweeper([&] { OutputFolder folder(place_); });
  after_exchange = [&](const fs::path&) {
    after_exchange = nullptr;
    EXPECT_TRUE(sweeper.work(long_ms));
  };
  {
    OutputFolder folder(place_);
    write_file(folder.path() / "a.txt", "new");
    fs::create_directory(place_);
    write_bytes(place_ / "precious.txt", "mine");
    EXPECT_THROW(folder.publish(), IoError);
  }
  EXPECT_EQ(read_bytes(place_ / "precious.txt"), "mine");
  EXPECT_FALSE(fs::exists(place_ / "a.txt"));
  EXPECT_EQ(sweeper.wait(), 0);
  EXPECT_THAT(names(), testing::ElementsAre("result"));
}

TEST_F(PublishRace, LetsNoOtherResultInWhileItMayHaveToGoBack) {
  publish(place_, "former");
  OtherRun other([&] { publish(place_, "other"); });
  after_exchange = [&](const fs::path&) {
    after_exchange = nullptr;
    EXPECT_FALSE(other.work(moment_ms)) << "would be taken away again when the former result is put back";
  };
  {
    OutputFolder folder(place_);
    write_file(folder.path() / "a.txt", "new");
    write_bytes(place_ / "notes.txt", "mine");
    EXPECT_THROW(folder.publish(), IoError);
  }
  EXPECT_EQ(other.wait(), 2) << "notes.txt is back, and keeps the other result from taking its place";
  EXPECT_EQ(content_of(place_), "former");
  EXPECT_EQ(read_bytes(place_ / "notes.txt"), "mine");
  EXPECT_THAT(names(), testing::ElementsAre("result"));
}

TEST_F(PublishRace, LetsTheOtherResultInAfterwards) {
  publish(place_, "former");
  OtherRun other([&] { publish(place_, "other"); });
  after_exchange = [&](const fs::path&) {
    after_exchange = nullptr;
    other.work(moment_ms);
  };
  publish(place_, "new");
  EXPECT_EQ(other.wait(), 0);
  EXPECT_EQ(content_of(place_), "other");
  EXPECT_THAT(names(), testing::ElementsAre("result"));
}

TEST_F(PublishRace, NeverExchangesWhatIsNoFolder) {
  bool exchanged = false;
  after_exchange = [&](const fs::path&) { exchanged = true; };
  {
    OutputFolder folder(place_);
    write_file(folder.path() / "a.txt", "new");
    write_bytes(place_, "mine");
    EXPECT_THROW(folder.publish(), IoError);
  }
  EXPECT_FALSE(exchanged) << "a sweeper would take it for a file that a dead run left";
  EXPECT_EQ(read_bytes(place_), "mine");
}

}  // namespace
}  // namespace dynasurf::io
