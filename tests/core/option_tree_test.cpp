#include "dynasurf/core/option_tree.hpp"

#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

#include "support/toy_options.hpp"

namespace dynasurf {
namespace {

using test::Toy;
using test::ToyBlur;
using test::ToyEdge;

std::string error_of(std::string_view assignment) {
  Toy toy;
  try {
    set_option(toy, assignment);
  } catch (const OptionError& error) {
    return error.what();
  }
  return "no error";
}

TEST(SetOption, SetsEveryKindOfMember) {
  Toy toy;
  set_option(toy, "width_mm=2.5");
  set_option(toy, "rounds=7");
  set_option(toy, "seed=18446744073709551615");
  set_option(toy, "title=a=b c");
  set_option(toy, "strict=true");
  set_option(toy, "colour=blue");
  set_option(toy, "limit=4");
  set_option(toy, "inner.depth=-3");
  EXPECT_EQ(toy.width_mm, 2.5);
  EXPECT_EQ(toy.rounds, 7);
  EXPECT_EQ(toy.seed, std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(toy.title, "a=b c");
  EXPECT_TRUE(toy.strict);
  EXPECT_EQ(toy.colour, test::Colour::blue);
  EXPECT_EQ(toy.limit, 4);
  EXPECT_EQ(toy.inner.depth, -3);
  set_option(toy, "limit=unset");
  EXPECT_FALSE(toy.limit.has_value());
}

TEST(SetOption, ReadsListsWithBracketsOrWithout) {
  Toy toy;
  set_option(toy, "counts=[7, 8]");
  EXPECT_THAT(toy.counts, testing::ElementsAre(7, 8));
  set_option(toy, "counts=9");
  EXPECT_THAT(toy.counts, testing::ElementsAre(9));
  set_option(toy, "place_mm=1.5,-2,3e1");
  EXPECT_THAT(*toy.place_mm, testing::ElementsAre(1.5, -2, 30));
  set_option(toy, "place_mm=unset");
  EXPECT_FALSE(toy.place_mm.has_value());
  for (const char* bad :
       {"counts=", "counts=1,", "counts=[1", "counts=1,10", "counts=1.5", "place_mm=1,2", "place_mm=1,2,nan"})
    EXPECT_THAT(error_of(bad), testing::HasSubstr("; expected ")) << bad;
}

TEST(SetOption, ReachesIntoTheMethodThatIsCurrent) {
  Toy toy;
  set_option(toy, "step.sigma=4");
  EXPECT_EQ(std::get<ToyBlur>(toy.step).sigma, 4);
}

TEST(SetOption, KeepsTheOptionsOfAMethodThatIsChosenAgain) {
  Toy toy;
  set_option(toy, "step.sigma=4");
  set_option(toy, "step=blur");
  EXPECT_EQ(std::get<ToyBlur>(toy.step).sigma, 4);
  set_option(toy, "step.method=edge");
  set_option(toy, "step.method=blur");
  EXPECT_EQ(std::get<ToyBlur>(toy.step).sigma, ToyBlur{}.sigma) << "another method in between starts anew";
}

TEST(SetOptions, RefuseWhatAnotherMethodWouldLose) {
  const auto set = [](std::vector<std::string> assignments) {
    Toy toy;
    set_options(toy, assignments);
    return toy;
  };
  EXPECT_EQ(std::get<ToyBlur>(set({"step=edge", "step=blur", "step.sigma=4"}).step).sigma, 4);
  EXPECT_EQ(std::get<ToyBlur>(set({"step.sigma=4", "step.method=blur"}).step).sigma, 4) << "the method is blur already";
  for (const char* other : {"step=edge", "step.method=edge"}) {
    try {
      set({"rounds=7", "step.sigma=4", other});
      FAIL() << other;
    } catch (const OptionError& error) {
      EXPECT_EQ(error.what(), "option step.sigma is set before " + std::string(other) +
                                  ", which begins with the defaults of edge; set it after that");
    }
  }
}

TEST(SetOption, NamesThePathAndTheRangeOfAValueThatDoesNotFit) {
  EXPECT_EQ(error_of("width_mm=21"), "option width_mm is '21'; expected a number >= 0 and <= 20 (mm)");
  EXPECT_EQ(error_of("width_mm=nan"), "option width_mm is 'nan'; expected a number >= 0 and <= 20 (mm)");
  EXPECT_EQ(error_of("width_mm=2mm"), "option width_mm is '2mm'; expected a number >= 0 and <= 20 (mm)");
  EXPECT_EQ(error_of("width_mm="), "option width_mm is ''; expected a number >= 0 and <= 20 (mm)");
  EXPECT_EQ(error_of("rounds=1.5"), "option rounds is '1.5'; expected a whole number >= 1");
  EXPECT_EQ(error_of("rounds=4294967297"), "option rounds is '4294967297'; expected a whole number >= 1");
  EXPECT_EQ(error_of("seed=-1"), "option seed is '-1'; expected a whole number >= 0");
  EXPECT_EQ(error_of("strict=yes"), "option strict is 'yes'; expected true or false");
}

TEST(SetOption, OffersTheChoicesAndTheNearestWord) {
  EXPECT_EQ(
      error_of("width_m=2"),
      "unknown option 'width_m'; did you mean 'width_mm'? choices: width_mm, rounds, seed, title, strict, colour, "
      "limit, counts, place_mm, inner, step");
  EXPECT_EQ(error_of("step.sgima=2"), "unknown option 'step.sgima'; did you mean 'step.sigma'? choices: method, sigma");
  EXPECT_THAT(error_of("wid=2"), testing::HasSubstr("did you mean 'width_mm'?"));
  EXPECT_EQ(error_of("colour=gren"), "option colour is 'gren'; did you mean 'green'? choices: red, green, blue");
  EXPECT_EQ(error_of("colour=mauve"), "option colour is 'mauve'; choices: red, green, blue");
  EXPECT_EQ(error_of("step=blurr"), "option step is 'blurr'; did you mean 'blur'? choices: blur, edge");
}

TEST(SetOption, FindsANameThatStandsInTheWrongPlace) {
  EXPECT_THAT(error_of("sigma=2"), testing::HasSubstr("did you mean 'step.sigma'?"));
}

TEST(SetOption, RefusesWhatIsNoSetting) {
  EXPECT_THAT(error_of("width_mm"), testing::HasSubstr("expected path=value"));
  EXPECT_THAT(error_of("=3"), testing::HasSubstr("expected path=value"));
  EXPECT_THAT(error_of("inner=3"), testing::HasSubstr("is a group; set one of its members: inner.depth"));
  EXPECT_THAT(error_of("width_mm.x=3"), testing::HasSubstr("has no members"));
  for (const char* path : {"inner.", "inner..depth", ".width_mm", "width_mm.", "."})
    EXPECT_THAT(error_of(path + std::string("=3")), testing::HasSubstr("expected path=value"));
}

TEST(CheckOptions, NamesThePathTheValueAndTheRange) {
  const auto error_of = [](const auto& change) -> std::string {
    Toy toy;
    change(toy);
    try {
      check_options(toy, "toy");
    } catch (const OptionError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of([](Toy& t) { t.width_mm = 20; }), "");
  EXPECT_EQ(error_of([](Toy& t) { t.width_mm = 20.5; }),
            "option toy.width_mm is 20.5; expected a number >= 0 and <= 20");
  EXPECT_EQ(error_of([](Toy& t) { t.width_mm = std::numeric_limits<double>::quiet_NaN(); }),
            "option toy.width_mm is nan; expected a number >= 0 and <= 20");
  EXPECT_EQ(error_of([](Toy& t) { t.rounds = 0; }), "option toy.rounds is 0; expected a number >= 1");
  EXPECT_EQ(error_of([](Toy& t) { t.limit = -1; }), "option toy.limit is -1; expected a number >= 0 and <= 100");
  EXPECT_EQ(error_of([](Toy& t) { t.inner.depth = 6; }),
            "option toy.inner.depth is 6; expected a number >= -5 and <= 5");
  EXPECT_EQ(error_of([](Toy& t) { t.step = ToyBlur{11}; }),
            "option toy.step.sigma is 11; expected a number >= 0 and <= 10");
}

TEST(OptionTable, HasARowForEveryLeafOfEveryMethod) {
  std::vector<std::string> paths;
  for (const OptionRow& row : option_table(Toy{}))
    paths.push_back(row.path + (row.method.empty() ? "" : "@") + row.method);
  EXPECT_THAT(paths, testing::ElementsAre("width_mm", "rounds", "seed", "title", "strict", "colour", "limit", "counts",
                                          "place_mm", "inner.depth", "step", "step.sigma@blur", "step.gain@edge"));
}

TEST(OptionTable, TellsDefaultUnitRangeAndChoices) {
  const auto rows = option_table(Toy{});
  EXPECT_EQ(rows[0].default_value, "1.25");
  EXPECT_EQ(rows[0].unit, "mm");
  EXPECT_EQ(rows[0].range, "0 to 20");
  EXPECT_EQ(rows[1].range, ">= 1");
  EXPECT_EQ(rows[5].choices, "red | green | blue");
  EXPECT_EQ(rows[6].default_value, "unset");
  EXPECT_EQ(rows[7].default_value, "3,2");
  EXPECT_EQ(rows[8].default_value, "unset");
  EXPECT_EQ(rows[10].choices, "blur | edge");
  EXPECT_EQ(rows[10].default_value, "blur");
}

struct ToyLimits {
  double share = 0.5, count = 1e6;
};
void describe(auto& visit, ToyLimits& o) {
  visit("share", o.share, OptionInfo{"a fraction", "", 0.25, 0.75});
  visit("count", o.count, OptionInfo{"large", "", 100000, 1e10});
}

TEST(OptionTable, WritesLimitsShort) {
  const auto rows = option_table(ToyLimits{});
  EXPECT_EQ(rows[0].range, "0.25 to 0.75");
  EXPECT_EQ(rows[1].range, "100000 to 1e+10");
}

TEST(OptionTable, ShowsThePresentValuesOfTheCurrentMethod) {
  Toy toy;
  toy.step = ToyEdge{9};
  const auto rows = option_table(toy);
  EXPECT_EQ(rows[11].path, "step.gain");
  EXPECT_EQ(rows[11].default_value, "9");
}

TEST(OptionTable, HoldsDefaultsThatCanBeSetAgain) {
  for (const OptionRow& row : option_table(Toy{})) {
    Toy toy;
    if (!row.method.empty()) set_option(toy, row.path.substr(0, row.path.find('.')) + "=" + row.method);
    EXPECT_NO_THROW(set_option(toy, row.path + "=" + row.default_value)) << row.path;
  }
}

}  // namespace
}  // namespace dynasurf
