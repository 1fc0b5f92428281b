#include "can/secoc/secoc_files.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/files.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::can {
namespace {

using testing::HasSubstr;

class SecocFilesTest : public testing::Test {
 protected:
  void write(const std::filesystem::path& file, const std::string& text,
             std::filesystem::perms permissions = std::filesystem::perms::owner_read |
                                                  std::filesystem::perms::owner_write) {
    std::ofstream(file) << text;
    std::filesystem::permissions(file, permissions);
  }

  const test::TemporaryFolder folder_;
  const std::filesystem::path key_ = folder_ / "key";
  const std::filesystem::path starts_ = folder_ / "starts";
};

TEST_F(SecocFilesTest, ReadsAKey) {
  write(key_, "2b7e151628aed2a6ABF7158809cf4f3c\n");
  const auto key = read_secoc_key(key_);
  ASSERT_TRUE(key) << key.error().message;
  EXPECT_EQ((*key)[0], 0x2b);
  EXPECT_EQ((*key)[8], 0xab);
  EXPECT_EQ((*key)[15], 0x3c);
}

TEST_F(SecocFilesTest, AKeyThatOthersMayReadIsRefused) {
  using std::filesystem::perms;
  for (const perms extra : {perms::group_read, perms::others_read, perms::group_write}) {
    write(key_, "2b7e151628aed2a6abf7158809cf4f3c", perms::owner_read | perms::owner_write | extra);
    const auto key = read_secoc_key(key_);
    ASSERT_FALSE(key);
    EXPECT_THAT(key.error().message, HasSubstr("wanted 0600"));
  }
}

TEST_F(SecocFilesTest, ADamagedKeyIsRefusedWithoutShowingIt) {
  EXPECT_FALSE(read_secoc_key(key_)) << "no file";
  for (const char* text :
       {"", "2b7e", "2b7e151628aed2a6abf7158809cf4fxy", "2b7e151628aed2a6abf7158809cf4f3c00",
        "+b7e151628aed2a6abf7158809cf4f3c"}) {
    write(key_, text);
    const auto key = read_secoc_key(key_);
    ASSERT_FALSE(key) << text;
    EXPECT_THAT(key.error().message, testing::Not(HasSubstr("2b7e")));
  }
}

TEST_F(SecocFilesTest, EachStartHasAHigherNumber) {
  for (uint32_t start = 1; start < 5; ++start) {
    const auto number = next_start_number(starts_);
    ASSERT_TRUE(number) << number.error().message;
    EXPECT_EQ(*number, start);
    EXPECT_EQ(read_file(starts_).value(), std::to_string(start) + "\n");
    EXPECT_FALSE(std::filesystem::exists(starts_.string() + ".new"));
  }
}

TEST_F(SecocFilesTest, AStartThatCannotBeCountedIsRefused) {
  for (const char* text : {"", "x", "-1", "4294967295", "12 13"}) {
    write(starts_, text);
    const auto number = next_start_number(starts_);
    ASSERT_FALSE(number) << text;
    EXPECT_THAT(number.error().message,
                HasSubstr("write a number larger than every number before"));
  }
}

TEST_F(SecocFilesTest, AKeyInPlaceOfTheNumberIsNotShown) {
  write(starts_, "2b7e151628aed2a6abf7158809cf4f3c\n");
  const auto number = next_start_number(starts_);
  ASSERT_FALSE(number);
  EXPECT_THAT(number.error().message, HasSubstr("starts: found 32 bytes that are no number"));
  EXPECT_THAT(number.error().message, testing::Not(HasSubstr("2b7e")));
}

TEST_F(SecocFilesTest, AFileThatCannotBeLookedForIsNoMissingFile) {
  const std::filesystem::path too_long = folder_ / std::string(300, 'x');
  for (const auto& number : {read_start_number(too_long), next_start_number(too_long)}) {
    ASSERT_FALSE(number);
    EXPECT_THAT(number.error().message, testing::StartsWith(too_long.string()));
    EXPECT_THAT(number.error().message, HasSubstr("File name too long"));
  }
}

TEST_F(SecocFilesTest, AFolderThatCannotBeWrittenIsNamedWithTheCause) {
  const auto number = next_start_number(folder_ / "none/starts");
  ASSERT_FALSE(number);
  EXPECT_THAT(number.error().message, HasSubstr("none/starts: the number of starts cannot be"));
  EXPECT_THAT(number.error().message, HasSubstr("No such file or directory"));
  EXPECT_THAT(number.error().message, HasSubstr("wanted a folder that bevlocd may write"));
}

}  // namespace
}  // namespace bevloc::can
