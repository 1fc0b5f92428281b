#include "drivers/gpio/line_lookup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bevloc::drivers {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::vector<GpioChipInfo> kChips{
    {"gpiochip0", "pinctrl", {{"", ""}, {"FSYNC", ""}, {"2", ""}, {"DOUBLE", ""}, {"DOUBLE", ""}}},
    {"gpiochip1", "expander", {{"LED", "leds-gpio"}}},
    {"gpiochip2", "expander", {{"LED", ""}}}};

std::string lookup_error(const std::string& chip, const std::string& line) {
  const auto place = find_line(kChips, {chip, line});
  return place ? "" : place.error().message;
}

TEST(LineLookup, FindsChipsByLabelAndNameAndLinesByNameAndNumber) {
  for (const char* chip : {"pinctrl", "gpiochip0"}) {
    for (const char* line : {"FSYNC", "1"}) {
      const auto place = find_line(kChips, {chip, line});
      ASSERT_TRUE(place) << place.error().message;
      EXPECT_EQ(place->chip, 0U);
      EXPECT_EQ(place->line, 1U);
    }
  }
  // A name that looks like a number is still a name.
  EXPECT_EQ(find_line(kChips, {"pinctrl", "2"})->line, 2U);
  EXPECT_EQ(find_line(kChips, {"pinctrl", "0"})->line, 0U);
}

TEST(LineLookup, ListsTheAvailableChips) {
  EXPECT_THAT(
      lookup_error("nothing", "1"),
      AllOf(HasSubstr("nothing 1: "), HasSubstr("gpiochip0 (pinctrl), gpiochip1 (expander)")));
  EXPECT_THAT(find_line({}, {"nothing", "1"}).error().message, HasSubstr("available: none"));
}

TEST(LineLookup, RefusesAmbiguousAndUnknownLines) {
  EXPECT_THAT(lookup_error("expander", "LED"), HasSubstr("more than one GPIO chip"));
  EXPECT_THAT(lookup_error("pinctrl", "DOUBLE"), HasSubstr("more than one line"));
  for (const char* line : {"5", "-1", "1x", "led", "99999999999999999999"}) {
    EXPECT_THAT(lookup_error("pinctrl", line), HasSubstr("0 to 4")) << line;
  }
}

TEST(LineLookup, NamesTheUserOfALine) {
  EXPECT_TRUE(find_line(kChips, {"gpiochip1", "LED"}));
  const auto used = find_free_line(kChips, {"gpiochip1", "LED"});
  ASSERT_FALSE(used);
  EXPECT_THAT(used.error().message, HasSubstr("leds-gpio"));
  EXPECT_TRUE(find_free_line(kChips, {"gpiochip2", "LED"}));
  EXPECT_FALSE(find_free_line(kChips, {"gpiochip2", "lamp"}));
}

}  // namespace
}  // namespace bevloc::drivers
