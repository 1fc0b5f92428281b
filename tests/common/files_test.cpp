#include "common/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bevloc {
namespace {

class Files : public testing::Test {
 protected:
  std::filesystem::path path_ = std::filesystem::path(testing::TempDir()) /
                                testing::UnitTest::GetInstance()->current_test_info()->name();

  void TearDown() override { std::filesystem::remove(path_); }
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
  const auto directory = read_file(testing::TempDir());
  ASSERT_FALSE(directory.has_value());
  EXPECT_THAT(directory.error().message, testing::HasSubstr("directory"));
  const auto unwritable = write_file("/nonexistent/file", "x");
  ASSERT_FALSE(unwritable.has_value());
  EXPECT_THAT(unwritable.error().message, testing::HasSubstr("No such file"));
}

}  // namespace
}  // namespace bevloc
