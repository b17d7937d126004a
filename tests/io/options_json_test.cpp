#include "dynasurf/io/options_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"

#include "support/toy_options.hpp"

namespace dynasurf::io {
namespace {

using nlohmann::ordered_json;
using test::Toy;
using test::ToyEdge;

std::string error_of(std::string_view text) {
  Toy toy;
  try {
    options_from_text(text, toy);
  } catch (const OptionError& error) {
    return error.what();
  }
  return "no error";
}

TEST(OptionsJson, WritesEveryMemberInOrder) {
  Toy toy;
  EXPECT_EQ(
      options_to_json(nodes_of(toy)).dump(),
      R"({"width_mm":1.25,"rounds":10,"seed":1,"title":"toy","strict":false,"colour":"green","limit":null,"counts":[3,2],"place_mm":null,)"
      R"("inner":{"depth":2},"step":{"method":"blur","sigma":1.0}})");
}

TEST(OptionsJson, ReadsBackWhatItWrote) {
  Toy toy;
  toy.width_mm = 0.1;
  toy.seed = ~std::uint64_t{0};
  toy.limit = 3;
  toy.inner.depth = -1;
  toy.step = ToyEdge{8};
  Toy copy;
  options_from_text(options_to_text(toy), copy);
  EXPECT_EQ(options_to_text(copy), options_to_text(toy));
}

TEST(OptionsJson, LeavesWhatIsNotNamed) {
  Toy toy;
  toy.rounds = 4;
  options_from_text(R"({"inner": {"depth": 5}, "step": {"sigma": 2}})", toy);
  EXPECT_EQ(toy.rounds, 4);
  EXPECT_EQ(toy.inner.depth, 5);
  EXPECT_EQ(std::get<test::ToyBlur>(toy.step).sigma, 2);
}

TEST(OptionsJson, TakesTheWordOfAMethodAlone) {
  Toy toy;
  options_from_text(R"({"step": "edge"})", toy);
  EXPECT_TRUE(std::holds_alternative<ToyEdge>(toy.step));
}

TEST(OptionsJson, ReadsTheMethodWhereverItStands) {
  Toy toy;
  options_from_text(R"({"step": {"gain": 6, "method": "edge"}})", toy);
  EXPECT_EQ(std::get<ToyEdge>(toy.step).gain, 6);
}

TEST(OptionsJson, RefusesUnknownKeysWithThePathAndTheChoices) {
  EXPECT_THAT(error_of(R"({"roundz": 1})"), testing::HasSubstr("unknown option 'roundz'; did you mean 'rounds'?"));
  EXPECT_EQ(error_of(R"({"inner": {"dept": 1}})"),
            "unknown option 'inner.dept'; did you mean 'inner.depth'? choices: depth");
  EXPECT_EQ(error_of(R"({"step": {"method": "edge", "sigma": 1}})"),
            "unknown option 'step.sigma'; choices: method, gain");
  EXPECT_EQ(error_of(R"({"inner": {"method": "x"}})"), "unknown option 'inner.method'; choices: depth");
}

TEST(OptionsJson, RefusesWrongTypes) {
  EXPECT_EQ(error_of(R"({"width_mm": "2"})"), "option width_mm is \"2\"; expected a number >= 0 and <= 20 (mm)");
  EXPECT_EQ(error_of(R"({"width_mm": null})"), "option width_mm is null; expected a number >= 0 and <= 20 (mm)");
  EXPECT_EQ(error_of(R"({"width_mm": true})"), "option width_mm is true; expected a number >= 0 and <= 20 (mm)");
  EXPECT_EQ(error_of(R"({"rounds": 2.0})"), "option rounds is 2.0; expected a whole number >= 1");
  EXPECT_EQ(error_of(R"({"rounds": 4294967298})"), "option rounds is 4294967298; expected a whole number >= 1");
  EXPECT_EQ(error_of(R"({"seed": -1})"), "option seed is -1; expected a whole number >= 0");
  EXPECT_EQ(error_of(R"({"strict": 1})"), "option strict is 1; expected true or false");
  EXPECT_EQ(error_of(R"({"title": 1})"), "option title is 1; expected a text");
  EXPECT_EQ(error_of(R"({"colour": 1})"), "option colour is 1; expected one of red, green, blue");
  EXPECT_EQ(error_of(R"({"inner": 1})"), "option inner is 1; expected an object {...}");
  EXPECT_EQ(error_of(R"({"step": {"method": 1}})"), "option step.method is 1; expected one of the methods blur, edge");
  EXPECT_EQ(error_of("[]"), "the options are []; expected an object {...}");
}

TEST(OptionsJson, ReadsLists) {
  test::Toy toy;
  options_from_text(R"({"counts": [4, 5], "place_mm": [1, 2.5, 3]})", toy);
  EXPECT_THAT(toy.counts, testing::ElementsAre(4, 5));
  EXPECT_THAT(*toy.place_mm, testing::ElementsAre(1, 2.5, 3));
  options_from_text(R"({"counts": "6,7", "place_mm": null})", toy);  // a text, as earlier versions wrote
  EXPECT_THAT(toy.counts, testing::ElementsAre(6, 7));
  EXPECT_FALSE(toy.place_mm.has_value());
  EXPECT_EQ(error_of(R"({"counts": [1, 2.5]})"),
            "option counts is [1,2.5]; expected a list of whole numbers >= 0 and <= 9");
  EXPECT_EQ(error_of(R"({"place_mm": [1, 2]})"),
            "option place_mm is [1,2]; expected unset or a list of three numbers (mm)");
}

TEST(OptionsJson, RefusesValuesOutOfRange) {
  EXPECT_EQ(error_of(R"({"width_mm": -0.5})"), "option width_mm is -0.5; expected a number >= 0 and <= 20 (mm)");
  EXPECT_EQ(error_of(R"({"limit": 101})"), "option limit is 101; expected unset or a whole number >= 0 and <= 100");
  EXPECT_THAT(error_of(R"({"width_mm": 1e999})"),
              testing::HasSubstr("the options: line 1, column 18: a number too large"));
}

TEST(OptionsJson, RefusesAKeyThatStandsTwice) {
  EXPECT_EQ(
      error_of(R"({"rounds": 1, "rounds": 2})"),
      "the options: line 1, column 26: the object that ends here has the key \"rounds\" twice; expected each key once");
  EXPECT_EQ(
      error_of(R"({"inner": {"depth": 1, "depth": 1}})"),
      "the options: line 1, column 34: the object that ends here has the key \"depth\" twice; expected each key once");
}

TEST(OptionsJson, TellsWhereATextStopsBeingJson) {
  EXPECT_THAT(error_of("{\"rounds\": 1,\n}"), testing::HasSubstr("the options: line 2, column 1: syntax error"));
  EXPECT_THAT(error_of(""), testing::HasSubstr("the options: line 1, column 1: "));
  EXPECT_THAT(error_of(std::string(100000, '[')), testing::HasSubstr("nested too deep"));
}

TEST(OptionsJson, ChangesNothingWhenItRefuses) {
  Toy toy;
  EXPECT_THROW(options_from_text(R"({"rounds": 3, "width_mm": 99})", toy), OptionError);
  EXPECT_EQ(toy.rounds, Toy{}.rounds);
}

TEST(OptionsJson, StartsPathsWithThePrefixOfTheCaller) {
  Toy toy;
  EXPECT_THAT(
      [&] {
        options_from_json(ordered_json{{"inner", {{"depth", 9}}}}, toy, "toy");
      },
      testing::ThrowsMessage<OptionError>("option toy.inner.depth is 9; expected a whole number >= -5 and <= 5"));
}

}  // namespace
}  // namespace dynasurf::io
