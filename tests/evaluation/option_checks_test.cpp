// Tests the checks that command line options share.
#include "common/option_checks.h"

#include <algorithm>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  EXPECT_EQ(message_of(name_of("a folder"), "out"), "");
  EXPECT_EQ(message_of(name_of("a folder"), ""), "--option: found an empty name, wanted a folder");
}

TEST(OptionChecks, AnOutputFileIsNotStandardOutput) {
  EXPECT_EQ(message_of(output_file(), "a.json"), "");
  EXPECT_THAT(message_of(output_file(), ""), HasSubstr("found an empty name"));
  EXPECT_THAT(message_of(output_file(), "-"), HasSubstr("found '-'"));
}

}  // namespace
}  // namespace bevloc
