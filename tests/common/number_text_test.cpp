#include "common/number_text.h"

#include <cstdint>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

TEST(NumberTextTest, ParsesOneNumber) {
  EXPECT_EQ(parse_number<int>("-42"), -42);
  EXPECT_EQ(parse_number<uint64_t>("18446744073709551615"), UINT64_MAX);
  EXPECT_EQ(parse_number<uint32_t>("1fC", 16), 0x1FCU);
  EXPECT_EQ(parse_number<double>("-1.5e3"), -1500.0);
}

TEST(NumberTextTest, RefusesTextThatIsMoreOrLessThanOneNumber) {
  for (const char* text : {"", " 1", "1 ", "+1", "1x", "x", "0x1", "1.5"}) {
    EXPECT_FALSE(parse_number<int>(text)) << "'" << text << "'";
  }
  for (const char* text : {"", " 1.0", "1.0 ", "+1.0", "1.0.0", "1,0"}) {
    EXPECT_FALSE(parse_number<double>(text)) << "'" << text << "'";
  }
}

TEST(NumberTextTest, RefusesANumberThatTheTypeCannotHold) {
  EXPECT_FALSE(parse_number<uint32_t>("4294967296"));
  EXPECT_FALSE(parse_number<uint32_t>("-1"));
  EXPECT_FALSE(parse_number<double>("1e999"));
}

TEST(NumberTextTest, TrimsWhiteSpaceAndAPlus) {
  EXPECT_EQ(trimmed_number(" \t+12.5\r\n"), "12.5");
  EXPECT_EQ(trimmed_number("-3"), "-3");
  EXPECT_EQ(trimmed_number("+-3"), "+-3") << "this is no number";
  EXPECT_EQ(trimmed_number(" \n"), "");
}

}  // namespace
}  // namespace bevloc
