// A mapped file has one owner, which unmaps it.
#include "common/mapped_file.h"

#include <optional>
#include <type_traits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/files.h"
#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

using testing::HasSubstr;

static_assert(!std::is_copy_constructible_v<MappedFile>);
static_assert(!std::is_copy_assignable_v<MappedFile>);

TEST(MappedFile, KeepsItsBytesWhenItMoves) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "a", "first"));
  ASSERT_TRUE(write_file(folder / "b", "second"));
  std::optional<MappedFile> opened = MappedFile::open(folder / "a", "a text").value();
  MappedFile file = std::move(*opened);
  opened.reset();
  EXPECT_EQ(file.bytes(), "first");
  file = MappedFile::open(folder / "b", "a text").value();
  EXPECT_EQ(file.bytes(), "second");
}

TEST(MappedFile, RefusesWhatHasNoBytesAndSaysWhatItWanted) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "empty", ""));
  EXPECT_THAT(MappedFile::open(folder / "none", "a text").error().message,
              HasSubstr("none: found no readable file (No such file or directory), wanted a text"));
  EXPECT_FALSE(MappedFile::open(folder / "empty", "a text"));
  EXPECT_FALSE(MappedFile::open(folder.path(), "a text"));
}

}  // namespace
}  // namespace bevloc
