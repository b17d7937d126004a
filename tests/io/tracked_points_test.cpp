#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/cloud_io.hpp"

#include "../support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

using test::ScratchFolder;

TrackedFile read_text(const std::string& text) {
  const ScratchFolder folder;
  std::ofstream(folder / "points.csv", std::ios::binary) << text;
  return read_tracked_points(folder / "points.csv");
}

std::string refusal_of(const std::string& text) {
  try {
    read_text(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

const std::string head = "point,gate,x_mm,y_mm,z_mm\n";

TEST(TrackedPoints, ComeBackAsTheyWereWritten) {
  const ScratchFolder folder;
  const TrackedPoints written{{"a", "7"}, {{{1.1, -2, 1e-7}, {3, 4, 5}}, {{1.0 / 3, 0, 9}, {-6, 7, 8}}}};
  write_tracked_points(written, folder / "points.csv");
  const TrackedFile read = read_tracked_points(folder / "points.csv");
  EXPECT_EQ(read.points.name, written.name);
  EXPECT_EQ(read.points.gates, written.gates);
  EXPECT_TRUE(read.notes.empty());
}

TEST(TrackedPoints, ThatWereWrittenAreRefusedWhenCutAnywhere) {
  const ScratchFolder folder;
  write_tracked_points({{"a", "b"}, {{{1, 2, 3}, {3, 4, 5}}, {{3, 0, 9}, {6, 7, 8}}, {{1, 1, 1}, {2, 2, 2}}}},
                       folder / "points.csv");
  const std::string whole = test::read_bytes(folder / "points.csv");
  ASSERT_EQ(refusal_of(whole), "");
  for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_NE(refusal_of(whole.substr(0, size)), "") << size;
}

TEST(TrackedPoints, WithoutACountAreReadWithANote) {
  const TrackedFile read = read_text(head + "a,1,0,0,0\na,2,1,1,1\n");
  ASSERT_EQ(read.notes.size(), 1u);
  EXPECT_EQ(read.notes[0].code, "motion.no_count");
}

TEST(TrackedPoints, MayStandInAnyOrderOfRowsAndColumns) {
  const TrackedFile read =
      read_text("# tags\n\"Z\"; note; GATE; X; Y; Point\n3;far;2;1;2;p\n\n6; ;1;4;5;p\n9;x;1;7;8;q\n1;x;2;1;1;q\n");
  EXPECT_EQ(read.points.name, (std::vector<std::string>{"p", "q"}));
  ASSERT_EQ(read.points.gates.size(), 2u);
  EXPECT_EQ(read.points.gates[0][0], Vec3(4, 5, 6));
  EXPECT_EQ(read.points.gates[1][0], Vec3(1, 2, 3));
  EXPECT_EQ(read.points.gates[0][1], Vec3(7, 8, 9));
}

TEST(TrackedPoints, ThatWereLostInAGateAreLeftOutAndCounted) {
  const TrackedFile read = read_text(head + "a,1,0,0,0\nb,1,1,1,1\na,2,2,2,2\nc,2,3,3,3\n");
  EXPECT_EQ(read.points.name, std::vector<std::string>{"a"});
  ASSERT_EQ(read.notes.size(), 2u);
  EXPECT_EQ(read.notes[1].code, "motion.points_left_out");
  EXPECT_NE(read.notes[1].message.find("2 of 3"), std::string::npos);
}

TEST(TrackedPoints, OfADamagedFileAreRefusedWithTheLine) {
  const std::vector<std::pair<std::string, std::string>> bad{
      {"", "no rows"},
      {head, "no points"},
      {"point,gate,x_mm,y_mm\n", "no column 'z_mm'"},
      {"point,gate,x,y,z,x_mm\n", "twice"},
      {head + "a,1,0,0,0\na,1,0,0,0\n", "line 3: point 'a' is there twice in gate 1"},
      {head + "a,1,0,0\n", "line 2: a row of 4 cells; expected 5"},
      {head + "a,0,0,0,0\n", "gate 0 is out of range"},
      {head + "a,1001,0,0,0\n", "out of range"},
      {head + "a,1.5,0,0,0\n", "'1.5' stands for a gate"},
      {head + "a,1,nan,0,0\n", "out of range"},
      {head + "a,1,0,1e9,0\n", "out of range"},
      {head + "a,1,0,left,0\n", "'left' stands for a coordinate"},
      {head + ",1,0,0,0\n", "name of a point"},
      {head + std::string(41, 'a') + ",1,0,0,0\n", "name of a point"},
      {head + "a,1,0,0,0\n", "1 gate; expected 2"},
      {head + "a,1,0,0,0\na,3,0,0,0\n", "no point in gate 2 of 3"},
      {head + "a,1,0,0,0\na,2,0,0,", "no end"},
  };
  for (const auto& [text, reason] : bad) {
    const std::string said = refusal_of(text);
    EXPECT_NE(said.find(reason), std::string::npos) << text << "\n" << said;
    EXPECT_NE(said.find("points.csv"), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
  std::string many = head;
  for (int n = 0; n <= 2000; ++n) many += std::to_string(n) + ",1,0,0,0\n";
  EXPECT_NE(refusal_of(many).find("more than 2000 points"), std::string::npos);
  EXPECT_THROW(read_tracked_points("no/such/file.csv"), IoError);
}

}  // namespace
}  // namespace dynasurf::io
