#include "dynasurf/cohort/status.hpp"

#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dynasurf/cohort/detail/claims.hpp"
#include "dynasurf/cohort/detail/job_key.hpp"
#include "dynasurf/core/error.hpp"

#include "support/scratch_folder.hpp"

namespace dynasurf::cohort {
namespace {

StudyStatus row_of(const std::string& id) {
  StudyStatus row;
  row.id = id;
  row.done = true;
  row.verdict = "ok";
  row.started = "2026-01-01T00:00:00Z";
  row.wall_s = 1.25;
  return row;
}

/// Runs `work` in a child process; whether it said so.
template <class Work>
bool in_child(const Work& work) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work() ? 0 : 1);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

class Scratch : public testing::Test {
 protected:
  const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  test::ScratchFolder folder_;
};
class Claiming : public Scratch {};
class Status : public Scratch {};
class JobKey : public Scratch {};

TEST_F(Claiming, IsForOneProcessAtATime) {
  Claims claims(folder() / "claims");
  EXPECT_TRUE(claims.take("a"));
  EXPECT_TRUE(in_child([&] {
    Claims others(folder() / "claims");
    return !others.take("a") && others.take("b");
  }));
  claims.release("a");
  EXPECT_TRUE(in_child([&] { return Claims(folder() / "claims").take("a"); }));
}

TEST_F(Claiming, EndsWithItsProcessHoweverThatDies) {
  EXPECT_FALSE(in_child([&] {
    Claims claims(folder() / "claims");
    claims.take("a");
    ::kill(::getpid(), SIGKILL);
    return true;
  }));
  EXPECT_TRUE(Claims(folder() / "claims").take("a"));
}

TEST_F(Status, TellsTheLastRowOfAStudy) {
  StatusFile status(folder() / "status.tsv");
  StudyStatus row = row_of("p1");
  row.done = false;
  row.reason = "tab\tand\nline";
  status.append(row);
  status.append(row_of("p1"));
  EXPECT_TRUE(status.find("p1")->done);
  EXPECT_EQ(status.find("p2"), nullptr);
  const auto read = read_status(folder() / "status.tsv");
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read.at("p1").wall_s, 1.25);
}

TEST_F(Status, CutsALongReasonBetweenCharacters) {
  StatusFile status(folder() / "status.tsv");
  StudyStatus row = row_of("p1");
  row.reason = "x";
  for (int n = 0; n < 1500; ++n) row.reason += "é";
  status.append(row);
  const std::string kept = read_status(folder() / "status.tsv").at("p1").reason;
  EXPECT_EQ(kept, row.reason.substr(0, 1999));
}

TEST_F(Status, LosesNothingOfManyWriters) {
  constexpr int writers = 8, rows = 100;
  StatusFile mine(folder() / "status.tsv");
  std::set<pid_t> children;
  for (int w = 0; w < writers; ++w) {
    const pid_t child = ::fork();
    if (child == 0) {
      StatusFile status(folder() / "status.tsv");
      for (int n = 0; n < rows; ++n) status.append(row_of("p" + std::to_string(w) + "-" + std::to_string(n)));
      ::_exit(0);
    }
    children.insert(child);
  }
  for (const pid_t child : children) ::waitpid(child, nullptr, 0);
  mine.read_on();
  EXPECT_EQ(mine.all().size(), static_cast<std::size_t>(writers * rows));
}

TEST_F(Status, CutsOffARowThatWasNeverFinished) {
  { StatusFile(folder() / "status.tsv").append(row_of("p1")); }
  std::ofstream(folder() / "status.tsv", std::ios::app) << "p2\tdone\tok";
  EXPECT_EQ(read_status(folder() / "status.tsv").size(), 1U);
  StatusFile status(folder() / "status.tsv");
  status.append(row_of("p3"));
  EXPECT_EQ(status.all().size(), 2U);
  EXPECT_TRUE(status.find("p3"));
}

TEST_F(Status, RefusesWhatItDidNotWrite) {
  std::ofstream(folder() / "other.tsv") << "a\tb\n1\t2\n";
  EXPECT_THROW(StatusFile(folder() / "other.tsv"), InputError);
  { StatusFile(folder() / "status.tsv"); }
  std::ofstream(folder() / "status.tsv", std::ios::app) << "p2\tperhaps\n";
  EXPECT_THROW(StatusFile(folder() / "status.tsv"), InputError);
}

TEST_F(JobKey, FollowsContentAndPlaceOfFiles) {
  std::filesystem::create_directories(folder() / "study" / "b");
  std::ofstream(folder() / "study" / "a") << "1";
  std::ofstream(folder() / "study" / "b" / "c") << "2";
  const std::string before = input_hash(folder() / "study");
  EXPECT_EQ(input_hash(folder() / "study"), before);
  std::filesystem::rename(folder() / "study" / "a", folder() / "study" / "d");
  const std::string moved = input_hash(folder() / "study");
  EXPECT_NE(moved, before);
  std::ofstream(folder() / "study" / "d") << "3";
  EXPECT_NE(input_hash(folder() / "study"), moved);
  EXPECT_THROW(input_hash(folder() / "none"), IoError);
  EXPECT_EQ(input_stamp(folder() / "none"), "");
}

TEST_F(JobKey, FollowsWordsProgramAndTheFilesThatWordsName) {
  const std::string options = (folder() / "options.json").string();
  std::ofstream(options) << "{}";
  const std::string before = settings_hash({"ventricle", "--options", options}, "1");
  EXPECT_NE(settings_hash({"ventricle", "--options", options}, "2"), before);
  EXPECT_NE(settings_hash({"ventricle", "--options=" + options}, "1"), before);
  std::ofstream(options) << "{ }";
  EXPECT_NE(settings_hash({"ventricle", "--options", options}, "1"), before);
}

TEST_F(JobKey, SpreadsResultsOverFolders) {
  std::set<std::filesystem::path> parents;
  for (int n = 0; n < 10'000; ++n) parents.insert(result_folder(folder(), "p" + std::to_string(n)).parent_path());
  EXPECT_EQ(parents.size(), 256U);
}

}  // namespace
}  // namespace dynasurf::cohort
