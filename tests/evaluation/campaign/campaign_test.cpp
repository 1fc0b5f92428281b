// The short form of the campaign: every mode of the stage level with one seed.
#include "evaluation/campaign/campaign.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/evaluation/campaign/run_mode.h"
#include "tests/evaluation/own_config.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

CampaignOptions short_drives() {
  CampaignOptions options;
  options.first_seed = 2050;
  options.duration_s = 45.0;
  return options;
}

std::vector<std::string> stage_modes() {
  std::vector<std::string> names;
  for (const Mode& mode : all_modes()) {
    if (mode.on_stage) names.emplace_back(mode.name);
  }
  return names;
}

RunOutcome run_mode(const std::string& name) {
  return run_mode(name, short_drives());
}

/// Modes that do not keep their limit with the seed of this test yet, with the seconds beyond the
/// alert limits that they must not exceed.
const std::map<std::string, double>& known_failures() {
  static const std::map<std::string, double> kSeconds = {
      {"match-creeping", 11.0},
      {"match-creeping-along", 15.0},
      {"creeping-without-gnss", 11.0},
  };
  return kSeconds;
}

/// Modes that are not detected with the seed of this test. The filter estimates so small a fault,
/// and the pose stays right.
const std::set<std::string>& too_small_to_name() {
  static const std::set<std::string> kModes = {"odometry-scale", "odometry-scale-without-gnss",
                                               "yaw-bias-1"};
  return kModes;
}

/// Modes after whose fault the drives of this test end before the pose is right again.
const std::set<std::string>& recover_later() {
  static const std::set<std::string> kModes = {"yaw-bias-3", "yaw-bias-3-without-gnss",
                                               "odometry-late", "match-locked-1.2m-later"};
  return kModes;
}

TEST(ModeTableTest, HasDistinctNamesAndEnoughModes) {
  std::set<std::string_view> names;
  for (const Mode& mode : all_modes()) {
    EXPECT_TRUE(names.insert(mode.name).second) << mode.name;
    EXPECT_TRUE(mode.on_stage || mode.on_pictures) << mode.name;
    EXPECT_FALSE(mode.what.empty()) << mode.name;
  }
  EXPECT_GE(names.size(), 30);
}

/// A campaign with a configuration that has these keys.
Result<Campaign> campaign_with(const test::OwnKeys& keys) {
  const test::TemporaryFolder folder;
  return Campaign::create(test::write_own_config(folder.path(), keys),
                          BEVLOC_SOURCE_DIR "/evaluation/campaign/matches.csv", short_drives());
}

TEST(CampaignTest, DrivesThroughTheMapOfItsConfiguration) {
  const auto campaign =
      campaign_with({.map = "file: /no/such.osm", .calibration = "", .simulation = ""});
  ASSERT_TRUE(campaign) << campaign.error().message;
  const auto modes = modes_named({"none"}, Level::kStage);
  const Status driven = campaign->run(*modes, [](const CampaignRow&) {});
  ASSERT_FALSE(driven);
  EXPECT_THAT(driven.error().message, testing::HasSubstr("/no/such.osm"));
}

TEST(CampaignTest, RefusesFaultsOfItsConfiguration) {
  const auto campaign = campaign_with({.map = "procedural_seed: 7",
                                       .calibration = "",
                                       .simulation = "  faults: [{kind: gnss_outage}]\n"});
  ASSERT_FALSE(campaign);
  EXPECT_THAT(campaign.error().message, testing::HasSubstr("found simulation.faults"));
}

TEST(CampaignTest, NoDriveKnowsWhatAnotherOneLearned) {
  const auto campaign = campaign_with({.map = "procedural_seed: 7",
                                       .calibration = "  online: {file: /no/learned.yaml}\n",
                                       .simulation = ""});
  ASSERT_TRUE(campaign) << campaign.error().message;
  EXPECT_EQ(campaign->config().learned_calibration_file, "");
}

TEST(ModeTableTest, RefusesAnUnknownMode) {
  const auto modes = modes_named({"gnss-outage", "gnss-party"}, Level::kStage);
  ASSERT_FALSE(modes);
  EXPECT_THAT(modes.error().message, testing::HasSubstr("gnss-party"));
}

TEST(CampaignTest, RepeatsARunBitForBit) {
  const RunOutcome first = run_mode("odometry-spin");
  const RunOutcome second = run_mode("odometry-spin");
  EXPECT_GT(first.valid, 0);
  EXPECT_EQ(first.valid, second.valid);
  EXPECT_EQ(first.worst, second.worst);
  EXPECT_EQ(first.beyond_alert, second.beyond_alert);
}

TEST(CampaignTest, LocalizesWithoutAFault) {
  const RunOutcome outcome = run_mode("none");
  EXPECT_GE(outcome.first_fix_s, 0.0);
  EXPECT_LT(outcome.first_fix_s, 5.0);
  EXPECT_GT(outcome.valid_share(), 0.95);
  EXPECT_EQ(outcome.beyond_alert, 0);
  EXPECT_EQ(outcome.detected_by, "");
}

TEST(CampaignTest, BoundsTheErrorsOfADriveWithoutAFault) {
  const RunOutcome outcome = run_mode("none");
  ASSERT_GT(outcome.valid, 0);
  const PoseCounts all{outcome.valid, outcome.valid, outcome.valid};
  EXPECT_EQ(outcome.protection.with_level, all);
  EXPECT_EQ(outcome.protection.misleading, PoseCounts{});
  EXPECT_EQ(outcome.protection.hazardous, PoseCounts{});
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto share_of = [&](const PoseCounts& poses) {
      return static_cast<double>(poses[axis]) / static_cast<double>(outcome.valid);
    };
    EXPECT_GT(share_of(outcome.within_sigma[0]), 0.6) << "axis " << axis;
    EXPECT_GT(share_of(outcome.within_sigma[2]), 0.99) << "axis " << axis;
    EXPECT_GT(share_of(outcome.protection.available), 0.95) << "axis " << axis;
  }
}

TEST(CampaignTest, AnApplianceThatWakesUpNamesTheGapOfItsClock) {
  const RunOutcome outcome = run_mode("suspended");
  EXPECT_EQ(outcome.detected_by, "not valid") << "it is silent while it sleeps";
  EXPECT_TRUE(std::ranges::any_of(
      outcome.timeline, [](const TimelineEntry& entry) { return entry.why.has(Why::kClockGap); }));
}

/// Whether a why bit that names the fault of the mode is set at the end of the drive.
bool is_named_at_the_end(const RunOutcome& outcome, const Mode& mode) {
  return (outcome.timeline.back().why.bits() & mode.named_by.bits()) != 0;
}

class CampaignModeTest : public testing::TestWithParam<std::string> {};

TEST_P(CampaignModeTest, SendsNoDangerousPoseForLong) {
  const auto mode = std::ranges::find(all_modes(), GetParam(), &Mode::name);
  const RunOutcome outcome = run_mode(GetParam());
  EXPECT_GT(outcome.timeline.size(), 1);
  const auto known = known_failures().find(GetParam());
  EXPECT_LE(outcome.beyond_alert_s(),
            known == known_failures().end() ? mode->limit_s : known->second);
  const FaultTime fault = mode->time_in(short_drives().duration_s);
  if (fault.from_s > 0.0) {
    EXPECT_GE(outcome.first_fix_s, 0.0) << "without a valid pose before, the fault shows nothing";
    EXPECT_LT(outcome.first_fix_s, fault.from_s);
  }
  if (mode->named_by.bits() != 0 && !too_small_to_name().contains(GetParam())) {
    // A pose that never was valid cannot be lost.
    const bool never_valid = outcome.first_fix_s < 0.0;
    EXPECT_TRUE(outcome.detection_s || (never_valid && is_named_at_the_end(outcome, *mode)));
  }
  if (fault.until_s < short_drives().duration_s && !recover_later().contains(GetParam())) {
    EXPECT_TRUE(outcome.recovery_s);
  }
}

std::string test_name(const testing::TestParamInfo<std::string>& mode) {
  std::string name = mode.param;
  for (char& c : name) c = c == '-' || c == '.' ? '_' : c;
  return name;
}

INSTANTIATE_TEST_SUITE_P(Stage, CampaignModeTest, testing::ValuesIn(stage_modes()), test_name);

}  // namespace
}  // namespace bevloc::evaluation
