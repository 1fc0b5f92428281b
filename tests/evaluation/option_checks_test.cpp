// Tests the checks that command line options share.
#include "common/option_checks.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/capabilities.h"
#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

using testing::HasSubstr;

/// What CLI11 says of `--option TEXT`; empty if it accepts that.
std::string message_of(const CLI::Validator& check, const std::string& text) {
  CLI::App app;
  std::string value;
  app.add_option("--option", value)->check(check);
  std::vector<std::string> words{text, "--option"};  // in reverse, as CLI11 expects
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
  return "";
}

TEST(OptionChecks, ANumberIsFiniteAndInItsRange) {
  const CLI::Validator check = number_between(0.1, 1e6);
  for (const char* text : {"0.1", "60", "1e5", "1000000"}) EXPECT_EQ(message_of(check, text), "");
  for (const char* text : {"nan", "inf", "1e300", "0", "-1", "1000001", "", "5s", "1e999"}) {
    EXPECT_EQ(message_of(check, text),
              fmt::format("--option: found '{}', wanted a number from 0.1 to 1000000", text));
  }
}

TEST(OptionChecks, AWholeNumberHasNoSignAnd64Bits) {
  for (const char* text : {"0", "18446744073709551615", "0x1F"}) {
    EXPECT_EQ(message_of(whole_number(), text), "");
  }
  for (const char* text : {"-1", "18446744073709551616", "99999999999999999999", "1.5", "", "0x"}) {
    EXPECT_THAT(message_of(whole_number(), text),
                HasSubstr(fmt::format("found '{}', wanted a whole number from 0 to ", text)));
  }
}

TEST(OptionChecks, ANameIsNotEmpty) {
  EXPECT_EQ(message_of(is_name_of("a folder"), "out"), "");
  EXPECT_EQ(message_of(is_name_of("a folder"), ""),
            "--option: found an empty name, wanted a folder");
}

TEST(OptionChecks, AnOutputFileIsNotStandardOutput) {
  for (const CLI::Validator& check : {output_file(), output_name()}) {
    EXPECT_EQ(message_of(check, "a.json"), "");
    EXPECT_THAT(message_of(check, ""), HasSubstr("found an empty name"));
    EXPECT_THAT(message_of(check, "-"), HasSubstr("found '-'"));
  }
}

TEST(OptionChecks, AnOutputFileCanBeWritten) {
  const test::TemporaryFolder folder;
  const std::string there = folder / "there.json";
  const std::string missing = folder / "no/a.json";
  std::ofstream(there) << "{}";
  for (const std::string& good :
       {there, std::string(folder / "new.json"), std::string("/dev/null")}) {
    EXPECT_EQ(message_of(output_file(), good), "");
  }
  EXPECT_EQ(message_of(output_file(), folder.path()),
            fmt::format("--option: {}: found a folder, wanted the name of a file to write",
                        folder.path().string()));
  EXPECT_EQ(
      message_of(output_file(), missing),
      fmt::format("--option: {}: found no folder {}, wanted one for this file; create it first",
                  missing, (folder / "no").string()));
  EXPECT_THAT(message_of(output_file(), there + "/a.json"), HasSubstr("found no folder"));
  EXPECT_EQ(message_of(output_name(), missing), "") << "the command may create the folder";
}

/// A new file takes the place of the earlier one, so the folder must be writable.
TEST(OptionChecks, AReplacedFileNeedsAFolderThatMayBeWritten) {
  using std::filesystem::perms;
  const test::TemporaryFolder folder;
  const std::string there = folder / "rig.yaml";
  std::ofstream(there) << "a rig";
  std::filesystem::permissions(there, perms::owner_read);
  test::without_capabilities([&] {
    EXPECT_EQ(message_of(replaced_file(), there), "");
    EXPECT_EQ(message_of(replaced_file(), folder / "new.yaml"), "");
  });
  std::filesystem::permissions(there, perms::owner_read | perms::owner_write);
  std::filesystem::permissions(folder.path(), perms::owner_read | perms::owner_exec);
  test::without_capabilities([&] {
    EXPECT_THAT(message_of(replaced_file(), there),
                HasSubstr("found no way to write in the folder"));
  });
  EXPECT_THAT(message_of(replaced_file(), "/dev/null"), HasSubstr("found a folder or a device"));
  EXPECT_THAT(message_of(replaced_file(), folder / "no/a.yaml"), HasSubstr("found no folder"));
  EXPECT_THAT(message_of(replaced_file(), "-"), HasSubstr("found '-'"));
}

TEST(OptionChecks, AnOutputFileNeedsAFolderThatMayBeWritten) {
  const test::TemporaryFolder folder;
  std::filesystem::permissions(
      folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  test::without_capabilities([&folder] {
    EXPECT_THAT(message_of(output_file(), folder / "a.json"),
                HasSubstr("found no way to write in the folder"));
  });
}

}  // namespace
}  // namespace bevloc
