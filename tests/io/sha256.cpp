// The portable SHA-256 against the standard's examples and against the one that the program was built with. Both
// sources make the same class; here the portable one gets another name.
#define Hasher PortableHasher
#include "dynasurf/io/sha256_portable.cpp"
#undef Hasher

#include <string>

#include <gtest/gtest.h>

namespace dynasurf::io {
namespace {

std::string portable_sha256(std::string_view text, std::size_t piece = 1000) {
  PortableHasher hasher;
  for (; !text.empty(); text.remove_prefix(std::min(piece, text.size())))
    hasher.add(text.data(), std::min(piece, text.size()));
  return hexadecimal(hasher.finish());
}

TEST(PortableSha256, MatchesTheExamplesOfTheStandard) {
  EXPECT_EQ(portable_sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(portable_sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(portable_sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(portable_sha256(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(PortableSha256, AgreesWithTheProgramsOwnForEveryLengthAndPiece) {
  std::string text;
  for (std::size_t length = 0; length < 200; ++length) {
    for (const std::size_t piece : {1, 7, 64, 1000}) EXPECT_EQ(portable_sha256(text, piece), sha256_of(text));
    text += static_cast<char>(37 * length + 11);
  }
}

}  // namespace
}  // namespace dynasurf::io
