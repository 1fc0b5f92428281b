#include "common/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

class Files : public testing::Test {
 protected:
  const test::TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_ / "file";
};

TEST_F(Files, BytesComeBackAsTheyWere) {
  const std::string bytes("a\0b\r\n\xff", 6);
  ASSERT_TRUE(write_file(path_, bytes).has_value());
  EXPECT_EQ(read_file(path_).value(), bytes);
  ASSERT_TRUE(write_file(path_, "shorter").has_value());
  EXPECT_EQ(read_file(path_).value(), "shorter");
}

TEST_F(Files, AnEmptyFileIsAFile) {
  ASSERT_TRUE(write_file(path_, "").has_value());
  EXPECT_EQ(read_file(path_).value(), "");
}

TEST_F(Files, SaysWhyAFileCannotBeReadOrWritten) {
  const auto missing = read_file("/nonexistent/file");
  ASSERT_FALSE(missing.has_value());
  EXPECT_THAT(missing.error().message, testing::HasSubstr("No such file"));
  const auto directory = read_file(folder_.path());
  ASSERT_FALSE(directory.has_value());
  EXPECT_THAT(directory.error().message, testing::HasSubstr("directory"));
  const auto unwritable = write_file("/nonexistent/file", "x");
  ASSERT_FALSE(unwritable.has_value());
  EXPECT_THAT(unwritable.error().message, testing::HasSubstr("No such file"));
}

}  // namespace
}  // namespace bevloc
