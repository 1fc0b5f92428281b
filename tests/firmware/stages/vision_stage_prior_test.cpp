// Tests that observers get the motions of the prior, and that no camera has a fault without a
// prior.
#include <gtest/gtest.h>

#include "tests/firmware/stages/vision_stage_fixture.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;

class VisionStagePriorTest : public VisionStageImageTest {
 protected:
  /// Runs a frameset with this image in every camera; `spread` is from the first to the last.
  std::optional<VisionReport> show(Time time, Duration spread = {}) {
    for (int camera = 0; camera < kCameraCount; ++camera) {
      drivers::Frame frame;
      frame.camera = camera;
      frame.time = time + camera * spread / (kCameraCount - 1);
      frame.buffer = {lender_, 0, image_};
      frames_.push(std::move(frame));
    }
    return step();
  }
};

TEST_F(VisionStagePriorTest, ObserversGetTheMotionOfEachCamera) {
  VisionConfig config;
  config.synchronizer.tolerance = milliseconds(49);
  for (const bool compensates : {true, false}) {
    config.compensate_motion = compensates;
    stage_.emplace(*localizer_, config, frames_, predictions_, reports_);
    Prediction prediction;
    prediction.pose.time = Time(milliseconds(900));
    prediction.pose.speed_mps = 20.0;
    predictions_.push(prediction);
    CameraMotions motions{};
    stage_->observe(
        [&](const VisionSnapshot& snapshot) { motions = snapshot.reference_from_exposure; });
    ASSERT_TRUE(show(Time(milliseconds(900)), milliseconds(45)));
    for (int camera = 0; camera < kCameraCount; ++camera) {
      EXPECT_NEAR(motions[camera].x_m, compensates ? 0.18 * camera : 0.0, 1e-9) << camera;
    }
  }
}

/// Without a prior no image is judged, so nobody knows whether a camera is still dark.
TEST_F(VisionStagePriorTest, WithoutAPriorNoCameraIsCalledDark) {
  std::ranges::fill(rgb_, uint8_t{2});
  ASSERT_TRUE(show(Time(milliseconds(900))));
  EXPECT_EQ(stage_->counters().dark, 0b111111U);
  EXPECT_EQ(stage_->counters().no_prior, 0U);
  clock_.advance(std::chrono::seconds(1));
  ASSERT_TRUE(show(Time(milliseconds(1900))));
  EXPECT_EQ(stage_->counters().no_prior, 1U);
  EXPECT_EQ(stage_->counters().dark, 0U);
}

}  // namespace
}  // namespace bevloc::firmware
