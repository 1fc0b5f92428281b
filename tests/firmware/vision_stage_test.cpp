#include "firmware/vision_stage.h"

#include <gtest/gtest.h>

#include "sim/sim_rig.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;

/// Frames without pictures: nothing says yet where the vehicle is, so none is looked at.
class VisionStageTest : public testing::Test {
 protected:
  void SetUp() override {
    auto localizer = Localizer::create(sim::nominal_rig(), map_index_,
                                       std::string(BEVLOC_SOURCE_DIR) + "/models/nano.onnx", {});
    ASSERT_TRUE(localizer) << localizer.error().message;
    localizer_ = std::move(*localizer);
    stage_.emplace(*localizer_, drivers::SynchronizerConfig{}, frames_, predictions_, reports_);
  }

  void push_frameset(Time time) {
    for (int camera = 0; camera < kCameraCount; ++camera) {
      drivers::Frame frame;
      frame.camera = camera;
      frame.time = time;
      frames_.push(std::move(frame));
    }
  }

  std::optional<VisionReport> step() {
    stage_->step(clock_, Duration::zero());
    return reports_.pop(Duration::zero());
  }

  const HdMap map_;
  MapIndex map_index_{map_};
  std::unique_ptr<Localizer> localizer_;
  FrameQueue frames_{2 * kCameraCount};
  PredictionQueue predictions_{16};
  VisionQueue reports_{16};
  drivers::VirtualClock clock_{Time(milliseconds(1000))};
  std::optional<VisionStage> stage_;
};

TEST_F(VisionStageTest, TakesTheNewestFramesetAndSaysThatItSkippedOne) {
  push_frameset(Time(milliseconds(800)));
  push_frameset(Time(milliseconds(900)));
  auto report = step();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->frame_time, Time(milliseconds(900)));
  EXPECT_TRUE(report->skipped);
  EXPECT_EQ(stage_->counters().framesets_skipped, 1U);

  push_frameset(Time(milliseconds(1000)));
  report = step();
  ASSERT_TRUE(report);
  EXPECT_FALSE(report->skipped);
  EXPECT_FALSE(step());
}

TEST_F(VisionStageTest, MatchesNothingWithoutAPrediction) {
  push_frameset(Time(milliseconds(900)));
  const auto report = step();
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->present.all());
  EXPECT_FALSE(report->had_prior);
  EXPECT_EQ(report->correction.evidence, Evidence::kNone);
  EXPECT_EQ(stage_->counters().no_prior, 1U);
}

}  // namespace
}  // namespace bevloc::firmware
