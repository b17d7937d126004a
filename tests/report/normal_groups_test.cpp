#include "dynasurf/report/detail/normal_groups.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/report/normals.hpp"

#include "support/scratch_folder.hpp"

namespace dynasurf::report {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

GroupedMap study(const std::string& sex, const std::string& tracer, double value) {
  return {{sex, tracer}, ventricle::PolarValues(ventricle::PolarGrid{}.size(), value)};
}

/// Five women by tracer x, two by y, three men by x, and one of unknown sex.
NormalGroups normals() {
  std::vector<GroupedMap> studies;
  for (int n = 0; n < 5; ++n) studies.push_back(study("F", "x", 60.0 + 10 * n));  // mean 80
  for (int n = 0; n < 3; ++n) studies.insert(studies.begin(), study("M", "x", 60.0 + 10 * n));
  for (int n = 0; n < 2; ++n) studies.push_back(study("F", "y", 50));
  studies.push_back(study("", "x", 30));
  return build_normal_groups(std::move(studies), {"sex", "tracer"}, 4, ventricle::Perfusion::uptake);
}

TEST(NormalGroups, HaveAMapOfTheirOwnWhereThereAreEnoughStudies) {
  const NormalGroups found = normals();
  ASSERT_EQ(found.groups.size(), 3u);  // what is not known is no group
  EXPECT_EQ(found.all.studies, 11);
  EXPECT_DOUBLE_EQ(*found.all.mean[0], (400.0 + 210 + 100 + 30) / 11);
  EXPECT_THAT(found.groups[0].values, ::testing::ElementsAre("F", "x"));
  ASSERT_TRUE(found.groups[0].map);
  EXPECT_EQ(found.groups[0].map->studies, 5);
  EXPECT_DOUBLE_EQ(*found.groups[0].map->mean[7], 80);
  EXPECT_DOUBLE_EQ(*found.groups[0].map->sd[7], std::sqrt(1000.0 / 4));
  EXPECT_EQ(found.groups[0].map->perfusion_is, ventricle::Perfusion::uptake);
  EXPECT_EQ(found.groups[1].studies, 2);
  EXPECT_FALSE(found.groups[1].map);
  EXPECT_EQ(found.groups[2].studies, 3);
  EXPECT_FALSE(found.groups[2].map);
}

TEST(NormalGroups, AreChosenByTheirValuesAndElseAreAllStudies) {
  const NormalGroups found = normals();
  const ChosenNormals own = normals_for(found, {{"tracer", "x"}, {"sex", "F"}}, "n.json");
  EXPECT_EQ(own.map, &*found.groups[0].map);
  EXPECT_EQ(own.of, "5 studies of sex=F tracer=x");
  const ChosenNormals small = normals_for(found, {{"sex", "M"}, {"tracer", "x"}}, "n.json");
  EXPECT_EQ(small.map, &found.all);
  EXPECT_EQ(small.of, "all 11 studies, for there are only 3 of sex=M tracer=x");
  EXPECT_EQ(normals_for(found, {}, "n.json").of, "11 studies");
  EXPECT_THAT(
      [&] {
        normals_for(found, {{"sex", "M"}, {"tracer", "y"}}, "n.json");
      },
      ThrowsMessage<InputError>(HasSubstr("has no group sex=M tracer=y; expected one of: sex=F tracer=x; ")));
  EXPECT_THAT(
      [&] {
        normals_for(found, {{"sex", "M"}}, "n.json");
      },
      ThrowsMessage<InputError>(HasSubstr("has groups by tracer too")));
  EXPECT_THAT(
      [&] {
        normals_for(found, {{"site", "A"}}, "n.json");
      },
      ThrowsMessage<InputError>(HasSubstr("has no groups by site")));
}

TEST(NormalGroups, StandInAFileAsInMemory) {
  const test::ScratchFolder scratch;
  const NormalGroups found = normals();
  std::ofstream(scratch / "n.json") << normal_groups_text(found);
  const NormalGroups read = read_normal_groups(scratch / "n.json");
  EXPECT_EQ(normal_groups_text(read), normal_groups_text(found));
  std::ofstream(scratch / "one.json") << normals_text(found.all);
  const NormalGroups one = read_normal_groups(scratch / "one.json");
  EXPECT_TRUE(one.columns.empty());
  EXPECT_EQ(one.all.mean, found.all.mean);
  std::ofstream(scratch / "bad.json")
      << R"({"schema":"dynasurf.normal_groups/1","columns":["sex"],"least":3,"all":{},"groups":[]})";
  EXPECT_THAT([&] { read_normal_groups(scratch / "bad.json"); }, ThrowsMessage<InputError>(HasSubstr("bad.json")));
}

TEST(NormalGroups, NeedThreeStudiesInAll) {
  EXPECT_THROW(build_normal_groups({study("F", "x", 60), study("M", "x", 60)}, {"sex", "tracer"}, 3,
                                   ventricle::Perfusion::counts),
               InputError);
}

}  // namespace
}  // namespace dynasurf::report
