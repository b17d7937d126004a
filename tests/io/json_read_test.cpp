#include "dynasurf/io/detail/json_read.hpp"

#include <ctime>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/json_node.hpp"

#include "support/damage.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;
using testing::StartsWith;

/// What a text is refused with; "" when it is read. Several lines are a failure.
std::string json_refusal_of(const std::string& text) {
  try {
    parse_json(text, "a.json");
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    EXPECT_THAT(what, StartsWith("a.json: "));
    EXPECT_LT(what.size(), 250u) << what;
    return what;
  }
  return "";
}

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  all.reserve(text.size() * times);
  for (std::size_t n = 0; n < times; ++n) all += text;
  return all;
}

/// {"k0":0,"k1":0,...}
std::string wide_object(std::size_t keys) {
  std::string text = "{";
  for (std::size_t n = 0; n < keys; ++n) text += (n > 0 ? ",\"k" : "\"k") + std::to_string(n) + "\":0";
  return text + "}";
}

/// Of this process alone: other work on the machine does not count.
double cpu_seconds_of(const auto& work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

const std::string result_text = R"({"schema": "dynasurf.cloud/1", "levels": [{"name": "level1", "triangles": 80},
  {"name": "level2 \u00e4 Ä", "triangles": 20}], "timings_s": {"read": 1.5e-3, "write": -0.25}, "notes": [],
  "provenance": {"seed": 18446744073709551615, "offset": -9223372036854775808, "options": {}, "given": null,
  "flags": [true, false]}})";

TEST(ParseJson, GivesTheValueThatTheLibraryGives) {
  EXPECT_EQ(parse_json(result_text, "a.json"), ordered_json::parse(result_text));
  EXPECT_EQ(parse_json(result_text, "a.json").dump(2), ordered_json::parse(result_text).dump(2));
  for (const char* text : {"1", " null\n", "\"\"", "[]", "{}", "[[],[{}]]", "-0.0", "[1,2.5,\"a\"]"})
    EXPECT_EQ(parse_json(text, "a.json"), ordered_json::parse(text)) << text;
}

TEST(ParseJson, TellsLineColumnAndWhatWasExpected) {
  EXPECT_THAT(json_refusal_of("{\"rounds\": 1,\n}"), StartsWith("a.json: line 2, column 1: syntax error"));
  EXPECT_THAT(json_refusal_of("{\"rounds\": 1,\n}"), HasSubstr("; expected"));
  EXPECT_THAT(json_refusal_of(""), StartsWith("a.json: line 1, column 1: "));
  EXPECT_THAT(json_refusal_of("[1, 2"), StartsWith("a.json: line 1, column 6: "));
}

TEST(ParseJson, RefusesWhatIsNotOneStrictValue) {
  for (const std::string text :
       {"",         " ",         "[1,]",       "{\"a\":1,}",  "{a:1}",   "{'a':1}",   "[01]",  "[1.]", "[.5]",
        "[+1]",     "[NaN]",     "[Infinity]", "[-Infinity]", "[nul]",   "[1] [2]",   "[1]x",  "{}}",  "\"a",
        "[\"\t\"]", "[\"\\x\"]", "// a\n[1]",  "[1] // a",    "{\"a\"}", "{\"a\" 1}", "[1 2]", "]",    "\xef\xbb"})
    EXPECT_NE(json_refusal_of(text), "") << text;
  EXPECT_THAT(json_refusal_of(std::string("[1]\0[2]", 7)), HasSubstr("a zero byte"));
  EXPECT_THAT(json_refusal_of(std::string("[\"a\0b\"]", 7)), HasSubstr("a zero byte"));
}

TEST(ParseJson, RefusesTextThatIsNoUtf8) {
  for (const std::string bytes : {"\xff", "\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf5\x80\x80\x80", "\xe9"}) {
    EXPECT_NE(json_refusal_of("[\"" + bytes + "\"]"), "") << bytes;
    EXPECT_NE(json_refusal_of("{\"" + bytes + "\": 1}"), "") << bytes;
    EXPECT_NE(json_refusal_of("[1]" + bytes), "") << bytes;
  }
  EXPECT_NE(json_refusal_of("[\"\\ud800\"]"), "");  // half of a pair
  EXPECT_EQ(parse_json("\"\\ud83d\\ude00\"", "a.json"), "\xf0\x9f\x98\x80");
}

TEST(ParseJson, RefusesNumbersThatNoDoubleHolds) {
  EXPECT_THAT(json_refusal_of("[1e999]"), HasSubstr("a number too large"));
  EXPECT_THAT(json_refusal_of("[-1e309]"), HasSubstr("a number too large"));
  EXPECT_THAT(json_refusal_of("[" + std::string(100000, '9') + "]"), HasSubstr("a number too large"));
  EXPECT_EQ(parse_json("[1e-999, 1.7976931348623157e308]", "a.json")[1], 1.7976931348623157e308);
}

TEST(ParseJson, RefusesAKeyThatStandsTwice) {
  EXPECT_EQ(json_refusal_of("{\"a\": 1,\n \"b\": 2, \"a\": 1}"),
            "a.json: line 2, column 16: the object that ends here has the key \"a\" twice; expected each key once");
  EXPECT_THAT(json_refusal_of("[{\"b\": {\"\": 1, \"\\u0061\": 1, \"a\": 2}}]"), HasSubstr("\"a\" twice"));
  EXPECT_EQ(json_refusal_of("[{\"a\": 1}, {\"a\": {\"a\": 2}}]"), "");
}

TEST(ParseJson, RefusesDeepNestingAtItsLimit) {
  const auto nested = [](const std::string& open, const std::string& inside, const std::string& close, std::size_t n) {
    return repeated(open, n) + inside + repeated(close, n);
  };
  EXPECT_EQ(json_refusal_of(nested("[", "", "]", max_json_depth)), "");
  EXPECT_EQ(json_refusal_of(nested("{\"a\":", "1", "}", max_json_depth)), "");
  EXPECT_THAT(json_refusal_of(nested("[", "", "]", max_json_depth + 1)),
              HasSubstr("nested too deep; expected at most 64"));
  EXPECT_THAT(json_refusal_of(nested("{\"a\":", "1", "}", max_json_depth + 1)), HasSubstr("nested too deep"));
  EXPECT_THAT(json_refusal_of(nested("{\"a\":[", "1", "]}", 1000000)), HasSubstr("nested too deep"));
  EXPECT_THAT(json_refusal_of(std::string(10000000, '[')), HasSubstr("nested too deep"));
}

TEST(ParseJson, RefusesMoreValuesAndBytesThanItsLimits) {
  EXPECT_EQ(json_refusal_of("[" + repeated("0,", max_json_values - 2) + "0]"), "");
  EXPECT_THAT(json_refusal_of("[" + repeated("0,", max_json_values - 1) + "0]"), HasSubstr("too many values"));
  EXPECT_THAT(json_refusal_of("[" + repeated("[],", max_json_values) + "0]"), HasSubstr("too many values"));
  EXPECT_THAT(json_refusal_of(std::string(max_json_bytes + 1, ' ')), HasSubstr("at most 64 MiB"));
}

// With a look through all keys for each of them this would take minutes: 8e10 comparisons.
TEST(ParseJson, TakesTimeInProportionToTheKeys) {
  const std::string text = wide_object(400000);
  ordered_json json;
  EXPECT_LT(cpu_seconds_of([&] { json = parse_json(text, "a.json"); }), 10);
  EXPECT_EQ(json.size(), 400000u);
}

TEST(ParseJson, RefusesWithoutPrintingAFileOfOneWord) {
  EXPECT_NE(json_refusal_of("\"" + std::string(1000000, 'a')), "");
  EXPECT_NE(json_refusal_of("{\"" + std::string(1000000, 'k') + "\":1,\"" + std::string(1000000, 'k') + "\":2}"), "");
  EXPECT_NE(json_refusal_of(std::string(1000000, '1') + "x"), "");
}

TEST(ParseJson, RefusesEveryCut) {
  const std::string text = result_text.substr(0, result_text.size());
  for (std::size_t n = 0; n < text.size(); ++n) EXPECT_NE(json_refusal_of(text.substr(0, n)), "") << n;
}

TEST(ParseJson, ReadsOrRefusesDamagedTextAsTheLibraryDoes) {
  std::mt19937 random(3);
  int refused = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const std::string text = test::damaged(result_text, random);
    const ordered_json judged = ordered_json::parse(text, nullptr, false);
    const std::string refusal = json_refusal_of(text);
    refused += !refusal.empty();
    // We are stricter in these two only.
    const bool is_ours = refusal.find("twice") != std::string::npos || text.find('\0') != std::string::npos;
    EXPECT_TRUE(refusal.empty() ? parse_json(text, "a.json") == judged : judged.is_discarded() || is_ours)
        << text << "\n"
        << refusal;
  }
  EXPECT_GT(refused, 2500);
}

TEST(ReadJson, RefusesAPipeWithoutWaiting) {
  const test::ScratchFolder folder;
  ASSERT_EQ(::mkfifo((folder / "a.json").c_str(), 0600), 0);
  EXPECT_THAT([&] { read_json(folder / "a.json"); },
              testing::ThrowsMessage<IoError>(HasSubstr("a.json: is not a regular file")));
}

TEST(JsonText, ReplacesBytesThatAreNoUtf8) {
  EXPECT_EQ(json_text({{"file", "Jos\xe9.ply"}}, -1), "{\"file\":\"Jos\xef\xbf\xbd.ply\"}\n");
  EXPECT_EQ(json_text({{"a", 1}}), "{\n  \"a\": 1\n}\n");
}

/// A value that stays alive with its node.
struct Sample {
  ordered_json json = parse_json(
      R"({"a": {"b": [1, {"c": 2.5}, "x"], "n": null, "t": "word"}, "big": 18446744073709551615, "yes": true})",
      "r.json");
  JsonNode root = root_of(json, "r.json");
};

std::string error_of(const auto& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(JsonNode, FindsMembersAndItems) {
  const Sample s;
  const JsonNode a = object_in(s.root, "a"), b = list_in(a, "b");
  EXPECT_EQ(size_of(b), 3u);
  EXPECT_EQ(number_in(object_of(b, 1), "c"), 2.5);
  EXPECT_EQ(whole_of(item_of(b, 0), 1, 1), 1);
  EXPECT_EQ(text_in(a, "t"), "word");
  EXPECT_TRUE(flag_in(s.root, "yes"));
  EXPECT_TRUE(has(s.root, "a"));
  EXPECT_FALSE(has(a, "n"));
  EXPECT_FALSE(has(s.root, "absent"));
  EXPECT_FALSE(has(b, "a"));
}

TEST(JsonNode, NamesFileAndPathOfWhatIsMissingOrOfAnotherKind) {
  const Sample s;
  const JsonNode a = object_in(s.root, "a"), b = list_in(a, "b");
  EXPECT_EQ(error_of([&] { number_in(a, "edv_ml"); }), "r.json: a.edv_ml: missing; expected a number");
  EXPECT_EQ(error_of([&] { object_in(s.root, "q"); }), "r.json: q: missing; expected an object");
  EXPECT_EQ(error_of([&] { number_in(a, "t"); }), "r.json: a.t: \"word\"; expected a number");
  EXPECT_EQ(error_of([&] { text_in(a, "b"); }), "r.json: a.b: a list of 3; expected a text");
  EXPECT_EQ(error_of([&] { object_of(b, 0); }), "r.json: a.b[0]: 1; expected an object");
  EXPECT_EQ(error_of([&] { numbers_in(a, "b"); }), "r.json: a.b[1]: an object; expected a number");
  EXPECT_EQ(error_of([&] { flag_in(a, "n"); }), "r.json: a.n: null; expected true or false");
  EXPECT_EQ(error_of([&] { list_in(a, "n"); }), "r.json: a.n: null; expected a list");
  EXPECT_EQ(error_of([&] { number_in(b, "x"); }), "r.json: a.b: a list of 3; expected an object");
  EXPECT_EQ(error_of([&] { root_of(*b.json, "r.json"); }), "r.json: holds a list of 3; expected an object {...}");
}

TEST(JsonNode, KeepsWholeNumbersInTheirRange) {
  const Sample s;
  EXPECT_EQ(error_of([&] { whole_in(s.root, "big", 0, std::numeric_limits<std::int64_t>::max()); }),
            "r.json: big: 18446744073709551615; expected a whole number from 0 to 9223372036854775807");
  const JsonNode b = list_in(object_in(s.root, "a"), "b");
  EXPECT_EQ(error_of([&] { whole_of(item_of(b, 0), 2, 5); }), "r.json: a.b[0]: 1; expected a whole number from 2 to 5");
  EXPECT_EQ(error_of([&] { whole_in(object_of(b, 1), "c", 0, 5); }),
            "r.json: a.b[1].c: 2.5; expected a whole number from 0 to 5");
}

}  // namespace
}  // namespace dynasurf::io
