#include "firmware/vision_stage.h"

#include <gtest/gtest.h>

#include "sim/sim_rig.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;

/// Lends pictures that stay where they are.
class Lender final : public drivers::FrameLender {
  void give_back(int) noexcept override {}
};

/// Frames without pictures: nothing says yet where the vehicle is, so none is looked at.
class VisionStageTest : public testing::Test {
 protected:
  void SetUp() override {
    auto localizer = Localizer::create(sim::nominal_rig(), map_index_,
                                       std::string(BEVLOC_SOURCE_DIR) + "/models/nano.onnx", {});
    ASSERT_TRUE(localizer) << localizer.error().message;
    localizer_ = std::move(*localizer);
    stage_.emplace(*localizer_, VisionConfig{}, frames_, predictions_, reports_);
  }

  /// A stage that takes frames up to 50 ms apart into one set.
  void allow_spread(bool compensate_motion) {
    VisionConfig config;
    config.synchronizer.tolerance = milliseconds(50);
    config.compensate_motion = compensate_motion;
    stage_.emplace(*localizer_, config, frames_, predictions_, reports_);
  }

  /// The cameras one after the other, `spread` from the first to the last.
  void push_frameset(Time time, Duration spread = Duration::zero()) {
    for (int camera = 0; camera < kCameraCount; ++camera) {
      drivers::Frame frame;
      frame.camera = camera;
      frame.time = time + camera * spread / (kCameraCount - 1);
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

TEST_F(VisionStageTest, SaysThatCamerasAreUnsynchronizedOnlyWhereNothingMakesUpForIt) {
  for (const bool compensate_motion : {false, true}) {
    allow_spread(compensate_motion);
    push_frameset(Time(milliseconds(800)), milliseconds(4));
    auto report = step();
    ASSERT_TRUE(report);
    EXPECT_FALSE(report->unsynchronized);
    push_frameset(Time(milliseconds(900)), milliseconds(40));
    report = step();
    ASSERT_TRUE(report);
    EXPECT_TRUE(report->present.all());
    EXPECT_EQ(report->frame_time, Time(milliseconds(900)));
    EXPECT_EQ(report->unsynchronized, !compensate_motion);
  }
}

/// Half of the cameras at `time`, the other half 40 ms later.
TEST_F(VisionStageTest, SaysThatCamerasAreOutOfStep) {
  bool unsynchronized = false;
  for (int k = 0; k < 6; ++k) {
    const Time time = clock_.now();
    for (const int first : {0, 3}) {
      for (int camera = first; camera < first + 3; ++camera) {
        drivers::Frame frame;
        frame.camera = camera;
        frame.time = time + milliseconds(first == 0 ? 0 : 40);
        clock_.sleep_until(frame.time);
        frames_.push(std::move(frame));
      }
    }
    clock_.advance(milliseconds(60));
    while (const auto report = step()) unsynchronized = report->unsynchronized;
  }
  EXPECT_TRUE(unsynchronized);
}

TEST_F(VisionStageTest, SaysSoWhereNoSetHasEnoughCameras) {
  VisionConfig config;
  config.synchronizer.min_cameras = 4;
  stage_.emplace(*localizer_, config, frames_, predictions_, reports_);
  int told = 0;
  for (int k = 0; k < 20; ++k) {
    for (int camera = 0; camera < kCameraCount; ++camera) {
      drivers::Frame frame;
      frame.camera = camera;
      frame.time = clock_.now() + milliseconds(camera < 3 ? 0 : 40);
      frames_.push(std::move(frame));
    }
    clock_.advance(milliseconds(100));
    while (const auto report = step()) {
      EXPECT_TRUE(report->unsynchronized);
      EXPECT_TRUE(report->present.none());
      ++told;
    }
  }
  EXPECT_GE(told, 5);
  EXPECT_LE(told, 10);
  // Silent cameras are not out of step.
  clock_.advance(milliseconds(1000));
  EXPECT_FALSE(step());
}

TEST_F(VisionStageTest, MeasuresTheSpreadAndCountsSetsWithoutAPulse) {
  drivers::PulseLog pulses;
  VisionConfig config;
  config.pulses = &pulses;
  stage_.emplace(*localizer_, config, frames_, predictions_, reports_);
  pulses.add(Time(milliseconds(699)));
  push_frameset(Time(milliseconds(700)), milliseconds(2));
  ASSERT_TRUE(step());
  EXPECT_EQ(stage_->synchrony().off_pulse, 0U);
  push_frameset(Time(milliseconds(800)), milliseconds(1));
  ASSERT_TRUE(step());
  EXPECT_EQ(stage_->synchrony().off_pulse, 1U);
  EXPECT_EQ(stage_->synchrony().spread.load(), milliseconds(1));
  EXPECT_EQ(stage_->synchrony().spread_max.load(), milliseconds(2));
}

TEST_F(VisionStageTest, MatchesNothingWhenTheMotionToALaterFrameIsNotKnown) {
  allow_spread(true);
  Prediction prediction;
  prediction.pose.time = Time(milliseconds(760));
  predictions_.push(prediction);
  push_frameset(prediction.pose.time + PoseTrail::kReach, milliseconds(40));
  const auto report = step();
  ASSERT_TRUE(report);
  EXPECT_FALSE(report->had_prior);
}

/// Frames with a picture each, of which one may be what is no JPEG between its two markers.
class VisionStagePictureTest : public VisionStageTest {
 protected:
  static constexpr int kDamagedCamera = 4;

  void SetUp() override {
    VisionStageTest::SetUp();
    const Intrinsics lens = sim::nominal_rig().cameras[0].intrinsics;
    rgb_.resize(3 * static_cast<size_t>(lens.width_px) * static_cast<size_t>(lens.height_px));
    for (size_t i = 0; i < rgb_.size(); ++i) rgb_[i] = static_cast<uint8_t>(i / 1000);
    picture_ = RgbView{rgb_.data(), lens.width_px, lens.height_px, 3 * lens.width_px};
    damaged_ = picture_;
    damaged_.format = PixelFormat::kMjpeg;
    damaged_.planes[0] = {jpeg_.data(), 0};
    damaged_.bytes_used = jpeg_.size();
    Prediction prediction;
    prediction.pose.time = Time(milliseconds(850));
    predictions_.push(prediction);
  }

  void push_pictures(Time time, bool with_damaged) {
    for (int camera = 0; camera < kCameraCount; ++camera) {
      if (camera == kDamagedCamera && !with_damaged) continue;
      drivers::Frame frame;
      frame.camera = camera;
      frame.time = time;
      frame.buffer = {lender_, 0, camera == kDamagedCamera ? damaged_ : picture_};
      frames_.push(std::move(frame));
    }
  }

  const std::shared_ptr<Lender> lender_ = std::make_shared<Lender>();
  std::vector<uint8_t> rgb_;
  const std::vector<uint8_t> jpeg_{0xFF, 0xD8, 1, 2, 3, 4, 0xFF, 0xD9};
  ImageView picture_;
  ImageView damaged_;
};

TEST_F(VisionStagePictureTest, ACameraWithADamagedPictureIsMissingFromThatSetAlone) {
  std::vector<std::vector<float>> masks;
  stage_->observe([&](const VisionSnapshot& snapshot) {
    const auto mask = snapshot.localizer.perceived_mask();
    masks.emplace_back(mask.begin(), mask.end());
  });
  for (const bool with_damaged : {true, false}) {
    push_pictures(Time(milliseconds(with_damaged ? 900 : 910)), with_damaged);
    const auto report = step();
    ASSERT_TRUE(report);
    EXPECT_TRUE(report->had_prior);
    EXPECT_EQ(report->present, CameraMask().set().reset(kDamagedCamera));
  }
  ASSERT_EQ(masks.size(), 2U);
  EXPECT_EQ(masks[0], masks[1]);
  EXPECT_EQ(stage_->counters().refused, 0U);
  for (int camera = 0; camera < kCameraCount; ++camera) {
    EXPECT_EQ(stage_->counters().unreadable[camera], camera == kDamagedCamera ? 1U : 0U);
  }
}

TEST_F(VisionStagePictureTest, ASetWithTooFewReadablePicturesIsRefused) {
  VisionConfig config;
  config.synchronizer.min_cameras = kCameraCount;
  stage_.emplace(*localizer_, config, frames_, predictions_, reports_);
  bool observed = false;
  stage_->observe([&](const VisionSnapshot&) { observed = true; });
  push_pictures(Time(milliseconds(900)), true);
  const auto report = step();
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->had_prior);
  EXPECT_EQ(report->correction.evidence, Evidence::kNone);
  EXPECT_FALSE(observed);
  EXPECT_EQ(stage_->counters().refused, 1U);
  EXPECT_EQ(stage_->counters().unreadable[kDamagedCamera], 1U);
}

/// A drive at ten sets a second in which one camera may repeat its picture.
class VisionStageFrozenTest : public VisionStagePictureTest {
 protected:
  static constexpr int kFrozenCamera = 2;
  static constexpr int kBroken = FrozenPictures::kRepetitions;

  void SetUp() override {
    VisionStagePictureTest::SetUp();
    stuck_rgb_ = rgb_;
    stuck_ = picture_;
    stuck_.planes[0].data = stuck_rgb_.data();
  }

  /// The cameras that the next set is made of.
  CameraMask drive_on(double speed_mps, bool frozen) {
    time_ += milliseconds(100);
    Prediction prediction;
    prediction.pose.time = time_;
    prediction.pose.speed_mps = speed_mps;
    predictions_.push(prediction);
    for (uint8_t& sample : rgb_) ++sample;
    for (int camera = 0; camera < kCameraCount; ++camera) {
      drivers::Frame frame;
      frame.camera = camera;
      frame.time = time_;
      frame.buffer = {lender_, 0, camera == kFrozenCamera && frozen ? stuck_ : picture_};
      frames_.push(std::move(frame));
    }
    clock_.sleep_until(time_);
    const auto report = step();
    return report && report->had_prior ? report->present : CameraMask();
  }

  void expect_all_used(double speed_mps, bool frozen, int sets) {
    for (int i = 0; i < sets; ++i) EXPECT_TRUE(drive_on(speed_mps, frozen).all()) << i;
  }

  Time time_{milliseconds(1000)};
  std::vector<uint8_t> stuck_rgb_;
  ImageView stuck_;
  const CameraMask others_ = CameraMask().set().reset(kFrozenCamera);
};

TEST_F(VisionStageFrozenTest, LeavesACameraOutWhosePictureStandsWhileTheVehicleDrives) {
  expect_all_used(-5.0, true, kBroken);
  EXPECT_EQ(stage_->counters().frozen, 0U);
  std::vector<std::vector<float>> masks;
  stage_->observe([&](const VisionSnapshot& snapshot) {
    const auto mask = snapshot.localizer.perceived_mask();
    masks.emplace_back(mask.begin(), mask.end());
  });
  EXPECT_EQ(drive_on(-5.0, true), others_);
  EXPECT_EQ(stage_->counters().frozen, 1U << kFrozenCamera);
  EXPECT_EQ(stage_->counters().unreadable[kFrozenCamera], 0U);
  // What it shows is of no influence any more.
  CameraImages seen{{}, others_};
  seen.images.fill(picture_);
  SolverResult solution;
  localizer_->localize(seen, Se2{}, SearchRange::kTracking, solution);
  const auto without = localizer_->perceived_mask();
  ASSERT_EQ(masks.size(), 1U);
  EXPECT_TRUE(std::ranges::equal(masks[0], without));
}

TEST_F(VisionStageFrozenTest, UsesTheCameraAgainAsSoonAsItsPictureChanges) {
  expect_all_used(5.0, true, kBroken);
  EXPECT_EQ(drive_on(5.0, true), others_);
  EXPECT_TRUE(drive_on(5.0, false).all());
  EXPECT_EQ(stage_->counters().frozen, 0U);
  expect_all_used(5.0, true, kBroken);
  EXPECT_EQ(drive_on(5.0, true), others_);
}

TEST_F(VisionStageFrozenTest, ABrightPixelIsAChange) {
  expect_all_used(5.0, true, kBroken);
  const size_t middle = stuck_rgb_.size() / 2 + static_cast<size_t>(stuck_.width) * 3 / 2;
  for (int i = 0; i < 3; ++i) {
    stuck_rgb_[middle] = static_cast<uint8_t>(stuck_rgb_[middle] ^ 0x80);
    EXPECT_TRUE(drive_on(5.0, true).all()) << i;
  }
}

TEST_F(VisionStageFrozenTest, JudgesNoPictureWhileTheVehicleStands) {
  expect_all_used(0.0, true, 4 * kBroken);
  EXPECT_EQ(stage_->counters().frozen, 0U);
}

}  // namespace
}  // namespace bevloc::firmware
