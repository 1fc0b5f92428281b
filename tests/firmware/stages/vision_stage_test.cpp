#include "firmware/stages/vision_stage.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <gmock/gmock.h>

#include "tests/firmware/log_capture.h"
#include "tests/firmware/stages/vision_stage_fixture.h"
#include "tests/pipeline/network/damaged_model.h"
#include "tests/pipeline/preprocessing/camera_images.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

TEST_F(VisionStageTest, ReportsTheNewestFramesetAndThatOneWasSkipped) {
  push_frameset(Time(milliseconds(800)));
  push_frameset(Time(milliseconds(900)));
  const auto report = step();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->frame_time, Time(milliseconds(900)));
  EXPECT_TRUE(report->skipped);
  EXPECT_EQ(stage_->counters().framesets, 1U);
  EXPECT_EQ(stage_->counters().frames_used, uint64_t{kCameraCount});
  EXPECT_FALSE(step());
}

TEST_F(VisionStageTest, ReportsUnsynchronizedCameras) {
  VisionConfig config;
  config.synchronizer.tolerance = milliseconds(50);
  config.compensate_motion = false;
  stage_.emplace(*localizer_, config, frames_, predictions_, reports_);
  push_frameset(Time(milliseconds(900)), milliseconds(40));
  const auto report = step();
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->unsynchronized);
}

TEST_F(VisionStageTest, ReportsUnsynchronizedCamerasWithoutAnyFrameset) {
  VisionConfig config;
  config.synchronizer.min_cameras = 4;
  stage_.emplace(*localizer_, config, frames_, predictions_, reports_);
  int reports = 0;
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
      EXPECT_EQ(report->frame_time, clock_.now());
      ++reports;
    }
  }
  EXPECT_GE(reports, 5);
  EXPECT_LE(reports, 10);
}

TEST_F(VisionStageTest, LeavesOutFramesWhoseStampsHaveJumped) {
  VisionConfig config;
  config.synchronizer.tolerance = milliseconds(50);
  for (const int jumped : {1, 3, 4}) {
    stage_.emplace(*localizer_, config, frames_, predictions_, reports_);
    for (int camera = 0; camera < kCameraCount; ++camera) {
      drivers::Frame frame;
      frame.camera = camera;
      frame.stamp_jumped = camera < jumped;
      frame.stamp_jumps = frame.stamp_jumped ? 2 : 1;
      frame.time = Time(milliseconds(frame.stamp_jumped ? 852 : 900));
      frames_.push(std::move(frame));
    }
    const auto report = step();
    ASSERT_TRUE(report);
    const bool most = jumped == 4;
    EXPECT_EQ(report->stamps_jumped, most);
    EXPECT_EQ(report->stamp_jumps, most ? 2U : 1U);
    EXPECT_EQ(stage_->counters().stamps_jumped, 0b111111U >> (kCameraCount - jumped));
    EXPECT_EQ(report->present, CameraMask(most ? 0b111111U : 0b111111U << jumped));
    EXPECT_EQ(report->frame_time, Time(milliseconds(most ? 852 : 900)));
  }
}

/// The stamps of three cameras jump by more than the synchronizer tolerates, so these cameras and
/// the others form framesets in turn.
TEST_F(VisionStageTest, HalfOfTheCamerasAreNotMost) {
  VisionConfig config;
  config.synchronizer.min_cameras = 3;
  stage_.emplace(*localizer_, config, frames_, predictions_, reports_);
  push_frameset(Time(milliseconds(900)));
  step();
  const auto report_on = [this](int first_camera, bool jumped, Time time) {
    for (int camera = first_camera; camera < first_camera + 3; ++camera) {
      drivers::Frame frame;
      frame.camera = camera;
      frame.stamp_jumped = jumped;
      frame.time = time;
      frames_.push(std::move(frame));
    }
    clock_.sleep_until(time + milliseconds(100));
    return step();
  };
  for (int i = 0; i < 4; ++i) {
    const Time time(milliseconds(1000 + 200 * i));
    const auto jumped = report_on(0, true, time);
    ASSERT_TRUE(jumped);
    EXPECT_FALSE(jumped->stamps_jumped);
    EXPECT_TRUE(jumped->present.none());
    const auto right = report_on(3, false, time + milliseconds(60));
    ASSERT_TRUE(right);
    EXPECT_FALSE(right->stamps_jumped);
    EXPECT_EQ(right->present, CameraMask(0b111000U));
    EXPECT_EQ(stage_->counters().stamps_jumped, 0b000111U);
  }
}

/// The stamps jump ahead of the clock, or before the frames that came before, so that no frameset
/// has the frames.
TEST_F(VisionStageTest, ReportsStampsThatJumpedOutOfEveryFrameset) {
  for (const Duration jump : {Duration(milliseconds(100)), Duration(milliseconds(-500))}) {
    stage_.emplace(*localizer_, VisionConfig{}, frames_, predictions_, reports_);
    push_frameset(clock_.now() - milliseconds(60));
    ASSERT_FALSE(step()->stamps_jumped);
    int reports = 0;
    for (int k = 0; k < 10; ++k) {
      clock_.advance(milliseconds(100));
      for (int camera = 0; camera < kCameraCount; ++camera) {
        drivers::Frame frame;
        frame.camera = camera;
        frame.stamp_jumped = true;
        frame.stamp_jumps = 1;
        frame.time = clock_.now() - milliseconds(60) + jump;
        if (jump < Duration::zero()) frame.time -= k * milliseconds(100);
        frames_.push(std::move(frame));
      }
      const auto report = step();
      if (!report) continue;
      EXPECT_TRUE(report->stamps_jumped);
      EXPECT_EQ(report->stamp_jumps, 1U);
      EXPECT_TRUE(report->present.none());
      ++reports;
    }
    EXPECT_EQ(reports, 5) << "one every 200 ms";
    EXPECT_EQ(stage_->counters().stamps_jumped, 0b111111U);
    push_frameset(clock_.now() - milliseconds(60));
    const auto back = step();
    ASSERT_TRUE(back);
    EXPECT_FALSE(back->stamps_jumped);
    EXPECT_TRUE(back->present.all());
  }
}

TEST_F(VisionStageTest, MatchesNothingWithoutAPrediction) {
  push_frameset(Time(milliseconds(900)));
  const auto report = step();
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->present.all());
  EXPECT_FALSE(report->had_prior);
  EXPECT_EQ(report->match.evidence, Evidence::kNone);
  EXPECT_EQ(stage_->counters().no_prior, 1U);
}

TEST_F(VisionStageImageTest, ACameraWithADamagedImageIsMissingFromThatFramesetOnly) {
  std::vector<std::vector<float>> masks;
  stage_->observe([&](const VisionSnapshot& snapshot) {
    const auto mask = snapshot.perceived_mask();
    masks.emplace_back(mask.begin(), mask.end());
  });
  for (const bool with_damaged : {true, false}) {
    push_images(Time(milliseconds(with_damaged ? 900 : 910)), with_damaged);
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

TEST_F(VisionStageImageTest, LogsOncePerCauseWhyAnImageCannotBeRead) {
  const LogCapture log;
  Time time(milliseconds(880));
  const auto show = [&](const std::vector<uint8_t>& jpeg) {
    damaged_.planes[0].data = jpeg.data();
    damaged_.bytes_used = jpeg.size();
    push_images(time += milliseconds(10), true);
    ASSERT_TRUE(step());
  };
  const auto lines = [&log] {
    const std::string text = log.text();
    return std::count(text.begin(), text.end(), '\n');
  };
  show({0x11, 0x22, 0x33, 0x44, 0x55, 0x66});  // libjpeg quotes the first two bytes
  show({0x77, 0x66, 0x55, 0x44, 0x33, 0x22});
  EXPECT_EQ(lines(), 1) << log.text();
  EXPECT_THAT(log.text(), HasSubstr("warning: camera back: unreadable image: JPEG frame: found an "
                                    "unreadable header (Not a JPEG file"));
  const RgbImage image(image_.width, image_.height);
  show(test::jpeg_image(image, TJSAMP_GRAY).bytes);
  EXPECT_EQ(lines(), 2) << log.text();
  EXPECT_THAT(log.text(), HasSubstr("found no colour, wanted YCbCr"));
  show(test::jpeg_image(RgbImage(64, 48), TJSAMP_420).bytes);
  EXPECT_EQ(lines(), 3) << log.text();
  EXPECT_THAT(log.text(), HasSubstr("found 64x48 pixels, wanted "));
  EXPECT_EQ(stage_->counters().unreadable[kDamagedCamera], 4U);
}

TEST_F(VisionStageImageTest, AFramesetWithTooFewReadableImagesIsNotMatched) {
  VisionConfig config;
  config.synchronizer.min_cameras = kCameraCount;
  stage_.emplace(*localizer_, config, frames_, predictions_, reports_);
  bool observed = false;
  stage_->observe([&](const VisionSnapshot&) { observed = true; });
  push_images(Time(milliseconds(900)), true);
  const auto report = step();
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->had_prior);
  EXPECT_EQ(report->match.evidence, Evidence::kNone);
  EXPECT_FALSE(observed);
  EXPECT_EQ(stage_->counters().refused, 1U);
  EXPECT_EQ(stage_->counters().unreadable[kDamagedCamera], 1U);
}

/// A drive at ten framesets per second in which one camera may repeat its image.
class VisionStageFrozenTest : public VisionStageImageTest {
 protected:
  static constexpr int kFrozenCamera = 2;
  static constexpr int kBroken = FrozenCameraDetector::kRepetitions;

  void SetUp() override {
    VisionStageImageTest::SetUp();
    stuck_rgb_ = rgb_;
    stuck_ = image_;
    stuck_.planes[0].data = stuck_rgb_.data();
  }

  /// Runs one frameset. Returns the cameras whose images were used.
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
      frame.buffer = {lender_, 0, camera == kFrozenCamera && frozen ? stuck_ : image_};
      frames_.push(std::move(frame));
    }
    clock_.sleep_until(time_);
    const auto report = step();
    return report && report->had_prior ? report->present : CameraMask();
  }

  void expect_all_used(double speed_mps, bool frozen, int framesets) {
    for (int i = 0; i < framesets; ++i) EXPECT_TRUE(drive_on(speed_mps, frozen).all()) << i;
  }

  Time time_{milliseconds(1000)};
  std::vector<uint8_t> stuck_rgb_;
  ImageView stuck_;
  const CameraMask others_ = CameraMask().set().reset(kFrozenCamera);
};

TEST_F(VisionStageFrozenTest, DoesNotUseACameraThatRepeatsItsImageWhileTheVehicleDrives) {
  expect_all_used(-5.0, true, kBroken);
  EXPECT_EQ(stage_->counters().frozen, 0U);
  std::vector<std::vector<float>> masks;
  stage_->observe([&](const VisionSnapshot& snapshot) {
    const auto mask = snapshot.perceived_mask();
    masks.emplace_back(mask.begin(), mask.end());
  });
  EXPECT_EQ(drive_on(-5.0, true), others_);
  EXPECT_EQ(stage_->counters().frozen, 1U << kFrozenCamera);
  EXPECT_EQ(stage_->counters().unreadable[kFrozenCamera], 0U);
  // Its image must have no influence: matching without the camera gives the same mask.
  CameraImages seen{{}, others_};
  seen.images.fill(image_);
  SolverResult solution;
  localizer_->localize(seen, Se2{}, SearchRange::kTracking, solution);
  const auto without = localizer_->perceived_mask();
  ASSERT_EQ(masks.size(), 1U);
  EXPECT_TRUE(std::ranges::equal(masks[0], without));
}

TEST_F(VisionStageFrozenTest, UsesTheCameraAgainAsSoonAsItsImageChanges) {
  expect_all_used(5.0, true, kBroken);
  EXPECT_EQ(drive_on(5.0, true), others_);
  EXPECT_TRUE(drive_on(5.0, false).all());
  EXPECT_EQ(stage_->counters().frozen, 0U);
  expect_all_used(5.0, true, kBroken - 1);  // the image is remembered
  EXPECT_EQ(drive_on(5.0, true), others_);
}

TEST_F(VisionStageFrozenTest, OneChangedPixelIsAChange) {
  expect_all_used(5.0, true, kBroken);
  const size_t middle = stuck_rgb_.size() / 2 + static_cast<size_t>(stuck_.width) * 3 / 2;
  for (int i = 0; i < 3; ++i) {
    stuck_rgb_[middle] = static_cast<uint8_t>(stuck_rgb_[middle] ^ 0x80);
    EXPECT_TRUE(drive_on(5.0, true).all()) << i;
  }
}

TEST_F(VisionStageFrozenTest, ChecksTheNetworkAtTheStartAndOnceAMinuteWhileStanding) {
  EXPECT_EQ(stage_->counters().checks, 1U);
  for (int i = 0; i < 12; ++i) drive_on(5.0, false);
  EXPECT_EQ(stage_->counters().checks, 1U);
  for (int i = 0; i < 12; ++i) drive_on(0.0, false);
  EXPECT_EQ(stage_->counters().checks, 2U);
  time_ += std::chrono::seconds(58);
  drive_on(0.0, false);
  EXPECT_EQ(stage_->counters().checks, 2U);
  time_ += std::chrono::seconds(2);
  drive_on(0.0, false);
  EXPECT_EQ(stage_->counters().checks, 3U);
  EXPECT_FALSE(stage_->counters().network_fault);
}

TEST_F(VisionStageFrozenTest, MatchesNothingWithADamagedNetwork) {
  const test::TemporaryFolder folder;
  const auto path = test::damaged_model(folder);
  localizer_ = Localizer::create(sim::nominal_rig(), map_index_, path.string(), {}).value();
  stage_.emplace(*localizer_, VisionConfig{}, frames_, predictions_, reports_);
  const auto early = step();
  ASSERT_TRUE(early) << "before the first frameset, too";
  EXPECT_TRUE(early->network_fault);
  push_frameset(Time(milliseconds(900)));
  const auto report = step();
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->network_fault);
  EXPECT_EQ(report->match.evidence, Evidence::kNone);
  EXPECT_TRUE(stage_->counters().network_fault);
}

TEST_F(VisionStageFrozenTest, DoesNotUseADarkCamera) {
  std::ranges::fill(stuck_rgb_, uint8_t{2});
  EXPECT_EQ(drive_on(0.0, true), others_);
  EXPECT_EQ(stage_->counters().dark, 1U << kFrozenCamera);
  EXPECT_EQ(stage_->counters().unreadable[kFrozenCamera], 0U);
  const ImageView dark = std::exchange(stuck_, damaged_);
  EXPECT_EQ(drive_on(0.0, true), others_);
  EXPECT_EQ(stage_->counters().dark, 0U) << "nobody knows";
  EXPECT_EQ(stage_->counters().unreadable[kFrozenCamera], 1U);
  stuck_ = dark;
  EXPECT_EQ(drive_on(0.0, true), others_);
  EXPECT_EQ(stage_->counters().dark, 1U << kFrozenCamera);
  for (int i = 1; i < ViewMonitor::kRecovery; ++i) EXPECT_EQ(drive_on(0.0, false), others_) << i;
  EXPECT_TRUE(drive_on(0.0, false).all());
  EXPECT_EQ(stage_->counters().dark, 0U);
}

TEST_F(VisionStageFrozenTest, DoesNotUseABlindedCamera) {
  std::ranges::fill(stuck_rgb_, uint8_t{250});
  EXPECT_EQ(drive_on(0.0, true), others_);
  EXPECT_EQ(stage_->counters().blinded, 1U << kFrozenCamera);
}

TEST_F(VisionStageFrozenTest, MatchesNothingWithSixDarkCameras) {
  for (int i = 0; i < 3; ++i) {
    std::ranges::fill(rgb_, static_cast<uint8_t>(i));  // drive_on() adds 1
    EXPECT_TRUE(drive_on(5.0, false).none());
    EXPECT_EQ(stage_->counters().dark, 0b111111U);
    EXPECT_EQ(stage_->counters().refused, static_cast<uint64_t>(i) + 1);
  }
}

/// Images without light repeat each other. The camera does not hang.
TEST_F(VisionStageFrozenTest, ABlackCameraIsNotCalledFrozen) {
  std::ranges::fill(stuck_rgb_, uint8_t{0});
  for (int i = 0; i <= kBroken + 1; ++i) {
    EXPECT_EQ(drive_on(5.0, true), others_) << i;
    EXPECT_EQ(stage_->counters().dark, 1U << kFrozenCamera) << i;
    EXPECT_EQ(stage_->counters().frozen, 0U) << i;
  }
}

TEST_F(VisionStageFrozenTest, JudgesNoImageWhileTheVehicleStands) {
  expect_all_used(0.0, true, 4 * kBroken);
  EXPECT_EQ(stage_->counters().frozen, 0U);
}

}  // namespace
}  // namespace bevloc::firmware
