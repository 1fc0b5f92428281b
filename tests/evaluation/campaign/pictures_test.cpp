// The short form of the campaign on pictures: some modes on short drives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/evaluation/campaign/run_mode.h"

namespace bevloc::evaluation {
namespace {

RunOutcome outcome_on_pictures(const std::string& mode) {
  static const auto kOutcomes = [] {
    CampaignOptions options;
    options.level = Level::kPictures;
    options.first_seed = 2051;
    options.duration_s = 12.0;
    return run_modes({"none", "camera-dead", "cameras-dark-start"}, options);
  }();
  return kOutcomes.at(mode);
}

TEST(PicturesCampaignTest, LocalizesWithoutAFault) {
  const RunOutcome outcome = outcome_on_pictures("none");
  EXPECT_GE(outcome.first_fix_s, 0.0);
  EXPECT_LT(outcome.first_fix_s, 5.0);
  EXPECT_GT(outcome.valid_share(), 0.95);
  EXPECT_EQ(outcome.beyond_alert, 0);
}

TEST(PicturesCampaignTest, NamesACameraThatSendsNoFrames) {
  const RunOutcome outcome = outcome_on_pictures("camera-dead");
  EXPECT_EQ(outcome.detected_by, "CameraMissing");
  EXPECT_LT(*outcome.detection_s, 0.5);
  EXPECT_LE(outcome.beyond_alert_s(), 0.3);
}

TEST(PicturesCampaignTest, SendsNoDangerousPoseInTheDark) {
  EXPECT_LE(outcome_on_pictures("cameras-dark-start").beyond_alert_s(), 0.3);
}

}  // namespace
}  // namespace bevloc::evaluation
