#include "dynasurf/io/detail/manifest.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

const std::string hash_a(64, 'a'), hash_b(64, 'b');

std::string sample_manifest() {
  return manifest_text({{"meshes/b.ply", 7, hash_b}, {"a name with blanks", 0, hash_a}});
}

TEST(Manifest, ComesBackAsItWasWritten) {
  const std::vector<ManifestEntry> files = parse_manifest(sample_manifest(), "m");
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0].name, "a name with blanks");
  EXPECT_EQ(files[0].bytes, 0u);
  EXPECT_EQ(files[0].sha256, hash_a);
  EXPECT_EQ(files[1].name, "meshes/b.ply");
  EXPECT_EQ(files[1].bytes, 7u);
  EXPECT_EQ(manifest_text(files), sample_manifest());
  EXPECT_TRUE(parse_manifest(manifest_text({}), "m").empty());
}

TEST(Manifest, IsRefusedWhenItIsCutWithinALine) {
  const std::string text = sample_manifest();
  for (std::size_t n = 0; n < text.size(); ++n) {
    const std::string cut = text.substr(0, n);
    // At the end of a line the first files are a manifest of their own: the rest of the folder is foreign to it.
    if (!cut.empty() && cut.back() == '\n')
      EXPECT_NO_THROW(parse_manifest(cut, "m"));
    else
      EXPECT_THROW(parse_manifest(cut, "m"), InputError) << n;
  }
}

TEST(Manifest, NamesThePlaceOfWhatItDoesNotUnderstand) {
  const auto with = [](const std::string& line) { return manifest_text({{"a", 1, hash_a}}) + line + "\n"; };
  for (const std::string& line :
       {std::string(), std::string("x"), hash_a, hash_a + " 1", hash_a + " 1 ", hash_a + " -1 b", hash_a + " 1b",
        hash_a.substr(1) + "A 1 b", hash_a + " 18446744073709551616 b", hash_a + " 1 /etc/passwd", hash_a + " 1 ../b",
        hash_a + " 1 b/../../c", hash_a + " 1 ./b", hash_a + " 1 b//c", hash_a + " 1 b/", hash_a + " 1 b\rc",
        hash_a + " 1 a", hash_a + " 1 A", hash_a + "  1 b"}) {
    try {
      parse_manifest(with(line), "result/manifest.txt");
      ADD_FAILURE() << line;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::StartsWith("result/manifest.txt: line 3 ")) << line;
    }
  }
  EXPECT_NO_THROW(parse_manifest(with(hash_a + " 1 b"), "m"));
  EXPECT_THROW(parse_manifest(with(hash_a + " 01 b"), "m"), InputError);  // no writer writes that
  EXPECT_THROW(parse_manifest(unfinished_manifest_text(), "m"), InputError);
}

TEST(Manifest, ListsNoNameThatALineCannotHold) {
  EXPECT_THROW(manifest_text({{"a\nb", 1, hash_a}}), IoError);
  EXPECT_THROW(manifest_text({{"", 1, hash_a}}), IoError);
  EXPECT_NO_THROW(manifest_text({{"jos\xe9", 1, hash_a}}));
}

TEST(FirstForeignFile, IsNoneInAnEmptyFolderAndTheFirstByNameElsewhere) {
  const test::ScratchFolder scratch;
  EXPECT_FALSE(first_foreign_file(scratch.path()));
  std::filesystem::create_directories(scratch / "empty/folders");
  EXPECT_FALSE(first_foreign_file(scratch.path()));
  for (const char* name : {"c", "empty/b", "d"}) test::write_bytes(scratch / name, "x");
  EXPECT_EQ(first_foreign_file(scratch.path())->name, "c");
  EXPECT_THAT(first_foreign_file(scratch.path())->why, testing::HasSubstr("no manifest.txt"));
}

}  // namespace
}  // namespace dynasurf::io
