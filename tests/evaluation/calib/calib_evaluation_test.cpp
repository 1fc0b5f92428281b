// `bevloc eval calib`: what it refuses, and what it makes of drives that cannot be refined.
#include "evaluation/calib/calib_evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/calib/calibration_errors.h"
#include "tests/evaluation/refusal.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;

TEST(CalibEvaluationTest, RefusesADriveWithTooFewFramesetsBeforeItDrawsOne) {
  EXPECT_THAT(test::refusal_of<CalibEvaluation>({"calib", "--duration", "5"}),
              HasSubstr("--duration: found 5 s with --interval 0.5, which gives 10 framesets, "
                        "wanted 20 or more"));
  EXPECT_THAT(test::refusal_of<CalibEvaluation>({"calib", "--duration", "100", "--interval", "10"}),
              HasSubstr("which gives 10 framesets"));
}

TEST(CalibEvaluationTest, ADriveThatCannotBeRefinedLeavesTheOthers) {
  CalibrationErrors errors;
  errors.leave_out(301, "too few framesets");
  EXPECT_EQ(errors.drives(), 0U);
  RigRefinement refinement;
  CalibrationErrors::Truth truth;
  for (size_t c = 0; c < kCameraCount; ++c) {
    truth[c].setZero();
    truth[c][kTimeOffset] = 0.02;
    refinement.cameras[c].change[kTimeOffset] = 0.021;
    refinement.cameras[c].sigma[kTimeOffset] = 0.0005;
  }
  errors.add(302, refinement, truth);
  EXPECT_EQ(errors.drives(), 1U);
  EXPECT_THAT(errors.to_table(), HasSubstr("time_offset_ms         6/6     20.000        1.000"));
  const nlohmann::json json = errors.to_json();
  EXPECT_EQ(json["drives"].size(), 1U);
  EXPECT_EQ(json["drives"][0]["seed"], 302);
  EXPECT_EQ(json["left_out"],
            nlohmann::json::parse(R"([{"seed": 301, "why": "too few framesets"}])"));
  const nlohmann::json& time_offset = json["errors"]["time_offset_ms"];
  EXPECT_NEAR(time_offset["rms_after"].get<double>(), 1.0, 1e-9);
  EXPECT_EQ(time_offset["within_1_sigma"], 0.0);
  EXPECT_EQ(time_offset["within_3_sigma"], 1.0);
}

}  // namespace
}  // namespace bevloc::evaluation
