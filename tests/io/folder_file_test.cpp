#include "dynasurf/io/detail/folder_file.hpp"

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;
using test::write_bytes;

TEST(PlainFileName, IsOneOfTheFolderAlone) {
  for (const char* name : {"level1", "level 1", "Jos\xc3\xa9", ".hidden", "a..b", "..."})
    EXPECT_TRUE(is_plain_file_name(name)) << name;
  for (const std::string& name :
       {std::string(), std::string("."), std::string(".."), std::string("../a"), std::string("/etc/passwd"),
        std::string("a/b"), std::string("a\\b"), std::string("a\0b", 3), std::string("a\nb"), std::string(201, 'a')})
    EXPECT_FALSE(is_plain_file_name(name)) << name;
}

TEST(FileInside, GivesThePathWhetherItIsThereOrNot) {
  const ScratchFolder folder;
  fs::create_directory(folder / "meshes");
  write_bytes(folder / "meshes" / "a.ply", "x");
  fs::create_symlink("a.ply", folder / "meshes" / "b.ply");
  for (const char* file : {"meshes/a.ply", "meshes/b.ply", "meshes/none.ply", "none/none.ply"})
    EXPECT_EQ(file_inside(folder.path(), file), folder / file);
}

TEST(FileInside, RefusesWhatLeadsOut) {
  const ScratchFolder folder;
  fs::create_directories(folder / "result" / "meshes");
  write_bytes(folder / "secret.ply", "x");
  fs::create_symlink("../../secret.ply", folder / "result" / "meshes" / "link.ply");
  fs::create_symlink("/etc", folder / "result" / "etc");
  fs::create_symlink("loop", folder / "result" / "loop");
  for (const char* file : {"../secret.ply", "meshes/../../secret.ply", "meshes/link.ply", "etc/passwd", "/etc/passwd",
                           "", ".", "meshes/..", "loop", "../result2/a"})
    EXPECT_THROW(file_inside(folder / "result", file), InputError) << file;
}

TEST(FileInside, FollowsALinkToTheFolderItself) {
  const ScratchFolder folder;
  fs::create_directory(folder / "result");
  fs::create_directory_symlink("result", folder / "link");
  EXPECT_EQ(file_inside(folder / "link", "results.json"), folder / "link" / "results.json");
}

}  // namespace
}  // namespace dynasurf::io
