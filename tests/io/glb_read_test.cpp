#include "dynasurf/io/detail/glb_read.hpp"

#include <cstring>
#include <filesystem>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/mesh_io.hpp"

#include "support/damage.hpp"
#include "support/sample_meshes.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

using detail::append;
using detail::decode_lod_glb;
using detail::load;
using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

/// Two levels as they are written.
const std::string& sample() {
  static const std::string bytes = [] {
    const test::ScratchFolder folder;
    std::vector<LodSurface> levels;
    for (const int fineness : {1, 0})
      levels.push_back({"level" + std::to_string(2 - fineness), test::lopsided_ball(fineness), {}, 0.5 * fineness, {}});
    write_lod_glb(levels, folder / "levels.glb");
    return test::read_bytes(folder / "levels.glb");
  }();
  return bytes;
}

json document_of(const std::string& bytes) {
  return json::parse(bytes.substr(20, load<std::uint32_t>(bytes.data() + 12)));
}

std::string binary_of(const std::string& bytes) {
  return bytes.substr(20 + load<std::uint32_t>(bytes.data() + 12) + 8);
}

std::string container(std::string text, const std::string& binary) {
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  append<std::uint32_t>(bytes, 2);
  append<std::uint32_t>(bytes, static_cast<std::uint32_t>(28 + text.size() + binary.size()));
  append<std::uint32_t>(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += "JSON" + text;
  append<std::uint32_t>(bytes, static_cast<std::uint32_t>(binary.size()));
  return bytes + std::string("BIN\0", 4) + binary;
}

/// What a file is refused with; "" when it is read.
std::string refusal_of(const std::string& bytes) {
  try {
    decode_lod_glb({"a.glb", bytes});
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    EXPECT_THAT(what, StartsWith("a.glb: "));
    return what;
  }
  return "";
}

/// The same for the sample with one value of its document changed.
std::string refusal_with(const std::string& pointer, const json& value) {
  json document = document_of(sample());
  document[json::json_pointer(pointer)] = value;
  return refusal_of(container(document.dump(), binary_of(sample())));
}

std::string refusal_without(const std::string& pointer) {
  json document = document_of(sample());
  const json::json_pointer place(pointer);
  document[place.parent_pointer()].erase(place.back());
  return refusal_of(container(document.dump(), binary_of(sample())));
}

TEST(ReadGlb, ReadsWhatTheContainerOfTheseTestsHolds) {
  EXPECT_EQ(refusal_of(container(document_of(sample()).dump(), binary_of(sample()))), "");
}

TEST(ReadGlb, RefusesOffsetsAndCountsThatWrapAround) {
  const std::uint64_t huge = std::numeric_limits<std::uint64_t>::max();
  for (const json& value : {json(huge), json(huge - 4143), json(huge / 12), json(huge / 12 + 1), json(-4144), json(-1),
                            json(1e300), json(1.5), json("7"), json(nullptr), json::array()}) {
    EXPECT_NE(refusal_with("/accessors/0/count", value), "") << value;
    EXPECT_NE(refusal_with("/bufferViews/0/byteLength", value), "") << value;
    EXPECT_NE(refusal_with("/buffers/0/byteLength", value), "") << value;
    if (value.is_null()) continue;  // as good as absent
    EXPECT_NE(refusal_with("/accessors/0/byteOffset", value), "") << value;
    EXPECT_NE(refusal_with("/bufferViews/0/byteOffset", value), "") << value;
  }
  // View, accessor and length of which each two are in range, and whose sum is 0 modulo 2^64.
  json document = document_of(sample());
  document["bufferViews"][0]["byteOffset"] = std::uint64_t{1} << 63;
  document["accessors"][0]["byteOffset"] = (std::uint64_t{1} << 63) - 4140;
  document["accessors"][0]["count"] = 345;
  EXPECT_THAT(refusal_of(container(document.dump(), binary_of(sample()))), HasSubstr("Offset: 92233720368547"));
}

TEST(ReadGlb, RefusesNumbersOutsideTheirViewAndBuffer) {
  const json document = document_of(sample());
  const auto length = document["bufferViews"][0]["byteLength"].get<std::int64_t>();
  const auto count = document["accessors"][0]["count"].get<std::int64_t>();
  EXPECT_THAT(refusal_with("/accessors/0/count", count + 1), HasSubstr("accessors[0]: ends at byte"));
  EXPECT_THAT(refusal_with("/accessors/0/count", 0), HasSubstr("accessors[0].count: 0; expected"));
  EXPECT_THAT(refusal_with("/accessors/0/byteOffset", 4), HasSubstr("accessors[0]: ends at byte"));
  EXPECT_THAT(refusal_with("/bufferViews/0/byteLength", length - 1), HasSubstr("accessors[0]: ends at byte"));
  EXPECT_THAT(refusal_with("/bufferViews/0/byteLength", 100000000), HasSubstr("bufferViews[0]: ends at byte"));
  EXPECT_THAT(refusal_with("/bufferViews/0/byteOffset", binary_of(sample()).size()), HasSubstr("ends at byte"));
  EXPECT_THAT(refusal_with("/bufferViews/0/byteOffset", 2), HasSubstr("expected a multiple of 4"));
  EXPECT_THAT(refusal_with("/buffers/0/byteLength", 100), HasSubstr("buffers[0].byteLength: 100; expected"));
}

TEST(ReadGlb, RefusesNumbersOfAnotherKind) {
  EXPECT_THAT(refusal_with("/accessors/0/type", "VEC2"), HasSubstr("accessors[0].type: expected VEC3"));
  EXPECT_THAT(refusal_with("/accessors/0/componentType", 5130), HasSubstr("accessors[0].componentType: 5130"));
  EXPECT_THAT(refusal_with("/accessors/0/sparse", json{{"count", 1}}), HasSubstr("accessors[0].sparse"));
  EXPECT_THAT(refusal_with("/bufferViews/0/byteStride", 16), HasSubstr("bufferViews[0].byteStride"));
  EXPECT_THAT(refusal_with("/bufferViews/0/buffer", 1), HasSubstr("bufferViews[0].buffer: 1"));
  EXPECT_THAT(refusal_with("/meshes/0/primitives/0/mode", 1), HasSubstr("mode: 1"));
}

TEST(ReadGlb, RefusesIndicesOfThingsThatAreNotThere) {
  for (const char* pointer : {"/nodes/0/mesh", "/meshes/0/primitives/0/attributes/POSITION",
                              "/meshes/0/primitives/0/indices", "/accessors/0/bufferView"}) {
    for (const json& value : {json(1000), json(-1), json(std::numeric_limits<std::uint64_t>::max()), json("a"),
                              json(nullptr), json(4294967296), json(1.0)})
      EXPECT_NE(refusal_with(pointer, value), "") << pointer << " " << value;
    EXPECT_THAT(refusal_without(pointer), HasSubstr("missing; expected a whole number")) << pointer;
  }
}

TEST(ReadGlb, RefusesADocumentWithoutItsParts) {
  for (const char* pointer :
       {"/nodes", "/meshes", "/accessors", "/bufferViews", "/buffers", "/nodes/0/name", "/nodes/0/translation",
        "/meshes/0/primitives", "/meshes/0/primitives/0/attributes", "/accessors/0/count", "/accessors/0/type",
        "/accessors/0/componentType", "/bufferViews/0/byteLength", "/bufferViews/0/buffer"}) {
    EXPECT_THAT(refusal_without(pointer), HasSubstr("missing; expected")) << pointer;
    for (const json& value : {json(7), json::array(), json::object(), json("a"), json(nullptr)}) {
      const bool is_right = pointer == std::string("/nodes/0/name") && value.is_string();
      EXPECT_EQ(refusal_with(pointer, value).empty(), is_right) << pointer << " " << value;
    }
  }
  EXPECT_NE(refusal_with("/nodes/0/translation", {1, 2}), "");
  EXPECT_NE(refusal_with("/nodes/0/translation", {1, 2, "3"}), "");
  EXPECT_NE(refusal_with("/nodes/0", 3), "");
}

TEST(ReadGlb, OpensNoOtherFile) {
  const test::ScratchFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe.bin").c_str(), 0600), 0);
  for (const std::string uri : {"pipe.bin", "/etc/passwd", "../../x.bin", "data:application/octet-stream;base64,AAAA",
                                "http://localhost/x", ""}) {
    EXPECT_THAT(refusal_with("/buffers/0/uri", uri), HasSubstr("buffers[0]: names another file (uri)"));
    EXPECT_THAT(refusal_with("/images", json::array({{{"uri", uri}}})), HasSubstr("images[0]: names another file"));
  }
  json document = document_of(sample());
  document["buffers"].push_back({{"byteLength", 100}, {"uri", "pipe.bin"}});
  EXPECT_THAT(refusal_of(container(document.dump(), binary_of(sample()))), HasSubstr("buffers[1]: names another file"));
  document["buffers"][1].erase("uri");
  EXPECT_THAT(refusal_of(container(document.dump(), binary_of(sample()))), HasSubstr("buffers: a list of 2"));
}

TEST(ReadGlb, ReadsTheSameNumbersForOneLevelAlone) {
  json document = document_of(sample());
  for (int copy = 0; copy < 1000; ++copy) document["nodes"].push_back(document["nodes"][0]);
  EXPECT_THAT(refusal_of(container(document.dump(), binary_of(sample()))), HasSubstr("is used twice"));
}

TEST(ReadGlb, RefusesVerticesThatAreNotFiniteOrNotThere) {
  for (const float value : {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN()}) {
    std::string binary = binary_of(sample());
    std::memcpy(binary.data() + 24, &value, 4);
    EXPECT_THAT(refusal_of(container(document_of(sample()).dump(), binary)), HasSubstr("vertex 2 is not finite"));
  }
  const json document = document_of(sample());
  const json& corners = document["accessors"][document["meshes"][0]["primitives"][0]["indices"].get<std::size_t>()];
  const auto begin = document["bufferViews"][corners["bufferView"].get<std::size_t>()]["byteOffset"].get<std::size_t>();
  for (const std::uint32_t vertex : {42u, 0x7fffffffu, 0xffffffffu}) {
    std::string binary = binary_of(sample());
    std::memcpy(binary.data() + begin + 12, &vertex, 4);
    EXPECT_THAT(refusal_of(container(document.dump(), binary)), HasSubstr("triangle 1 uses vertex"));
  }
}

TEST(ReadGlb, RefusesDeepAndDoubledJson) {
  std::string deep;
  for (int n = 0; n < 200000; ++n) deep += "{\"a\":";
  const std::string text = document_of(sample()).dump(), close(200000, '}');
  const std::string with_extras = text.substr(0, text.size() - 1) + ",\"extras\":" + deep + "1" + close + "}";
  EXPECT_THAT(refusal_of(container(with_extras, binary_of(sample()))), HasSubstr("nested too deep"));
  EXPECT_THAT(refusal_of(container(text.substr(0, text.size() - 1) + ",\"nodes\":[]}", binary_of(sample()))),
              HasSubstr("the key \"nodes\" twice"));
  EXPECT_THAT(refusal_of(container("[]", binary_of(sample()))), HasSubstr("expected an object"));
}

TEST(ReadGlb, ChecksTheContainer) {
  const std::string bytes = sample();
  const auto with_word = [&](std::size_t at, std::uint32_t word) {
    std::string changed = bytes;
    std::memcpy(changed.data() + at, &word, 4);
    return refusal_of(changed);
  };
  const std::uint32_t json_size = load<std::uint32_t>(bytes.data() + 12);
  EXPECT_THAT(with_word(0, 1), HasSubstr("no binary glTF"));
  EXPECT_THAT(with_word(4, 1), HasSubstr("no binary glTF"));
  for (const std::uint32_t size : {0u, 12u, static_cast<std::uint32_t>(bytes.size()) - 4, 0xffffffffu})
    EXPECT_THAT(with_word(8, size), HasSubstr("as its header says")) << size;
  for (const std::uint32_t size : {0u, 1u, json_size - 4, json_size + 4, json_size + 1, 0xfffffffcu, 0xffffffffu}) {
    EXPECT_NE(with_word(12, size), "") << size;
    EXPECT_NE(with_word(20 + json_size, size), "") << size;
  }
  EXPECT_THAT(with_word(16, 0x004e4942), HasSubstr("another chunk where its JSON chunk belongs"));
  EXPECT_THAT(with_word(24 + json_size, 0x4e4f534a), HasSubstr("another chunk where its binary chunk belongs"));
  EXPECT_NE(refusal_of(bytes + "more"), "");
}

TEST(ReadGlb, RefusesEveryCut) {
  for (std::size_t n = 0; n < sample().size(); ++n) EXPECT_NE(refusal_of(sample().substr(0, n)), "") << n;
}

TEST(ReadGlb, ReadsOrRefusesDamagedFiles) {
  std::mt19937 random(7);
  int refused = 0;
  for (int trial = 0; trial < 2000; ++trial) refused += !refusal_of(test::damaged(sample(), random)).empty();
  EXPECT_GT(refused, 500);
  // The header and the lengths put right again, so that the damage reaches the document.
  const std::string text = document_of(sample()).dump(), binary = binary_of(sample());
  refused = 0;
  for (int trial = 0; trial < 4000; ++trial)
    refused += !refusal_of(container(test::damaged(text, random), binary)).empty();
  EXPECT_GT(refused, 2000);
}

}  // namespace
}  // namespace dynasurf::io
