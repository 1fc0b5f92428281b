// Properties of the table of failure modes.
#include <algorithm>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/campaign/modes/mode.h"

namespace bevloc::evaluation {
namespace {

using sim::FaultKind;

bool has_fault(const Mode& mode, FaultKind kind) {
  return std::ranges::find(mode.faults, kind, &sim::Fault::kind) != mode.faults.end();
}

bool has_fault(const Mode& mode, MatchFaultKind kind) {
  const auto& faults = mode.match_faults;
  return std::ranges::find(faults, kind, &MatchFault::kind) != faults.end();
}

TEST(ModesTest, AManoeuvreAndAMissingHeadingAreNoFailure) {
  std::vector<std::string_view> without_failure;
  for (const Mode& mode : all_modes()) {
    if (!mode.fails()) without_failure.push_back(mode.name);
  }
  EXPECT_THAT(without_failure, testing::UnorderedElementsAre(
                                   "none", "gnss-no-heading", "gnss-no-heading-start", "crawl",
                                   "standing-start", "standing-start-no-heading", "reverse-start",
                                   "reverse-start-no-heading", "reverse"));
}

TEST(ModesTest, AModeOfTwoFaultsIsNotNamedByTheReasonOfTheFirst) {
  int two_faults = 0;
  for (const Mode& mode : all_modes()) {
    if (mode.faults.size() + mode.match_faults.size() < 2) continue;
    ++two_faults;
    EXPECT_FALSE(has_fault(mode, FaultKind::kGnssOutage) && mode.named_by.has(Why::kGnssMissing))
        << mode.name;
    EXPECT_FALSE(has_fault(mode, MatchFaultKind::kSawNothing) && mode.named_by.has(Why::kPoseStale))
        << mode.name;
    EXPECT_NE(mode.named_by, WhyMask()) << mode.name << ": its second fault has reasons";
  }
  EXPECT_GE(two_faults, 8);
}

TEST(ModesTest, ASuspensionIsOverAsSoonAsItHasBegun) {
  int suspensions = 0;
  for (const Mode& mode : all_modes()) {
    if (!has_fault(mode, FaultKind::kClockSuspend)) continue;
    ++suspensions;
    const FaultTime time = mode.time_in(60.0);
    EXPECT_GT(time.until_s, time.from_s) << mode.name;
    EXPECT_NEAR(time.until_s, time.from_s, 0.011) << mode.name << ": within a bus cycle";
  }
  EXPECT_GE(suspensions, 1);
}

}  // namespace
}  // namespace bevloc::evaluation
