// A vision stage with the shipped network, and frames for it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/stages/vision_stage.h"
#include "sim/sim_rig.h"

namespace bevloc::firmware {

/// Lends images of the test, which need not be given back.
class Lender final : public drivers::FrameLender {
  void give_back(int) noexcept override {}
};

/// Frames without images. Without a prior the stage does not read them.
class VisionStageTest : public testing::Test {
 protected:
  void SetUp() override {
    auto localizer = Localizer::create(sim::nominal_rig(), map_index_,
                                       std::string(BEVLOC_SOURCE_DIR) + "/models/nano.onnx", {});
    ASSERT_TRUE(localizer) << localizer.error().message;
    localizer_ = std::move(*localizer);
    stage_.emplace(*localizer_, VisionConfig{}, frames_, predictions_, reports_);
  }

  /// One frame of each camera at equal intervals; `spread` is from the first to the last.
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
  FrameQueue frames_{StageQueues::kFrames};
  PredictionQueue predictions_{16};
  VisionQueue reports_{16};
  drivers::VirtualClock clock_{Time(std::chrono::milliseconds(1000))};
  std::optional<VisionStage> stage_;
};

/// Frames with images. One image may be damaged: a JPEG with nothing valid between its two markers.
class VisionStageImageTest : public VisionStageTest {
 protected:
  static constexpr int kDamagedCamera = 4;

  void SetUp() override {
    VisionStageTest::SetUp();
    const Intrinsics lens = sim::nominal_rig().cameras[0].intrinsics;
    rgb_.resize(3 * static_cast<size_t>(lens.width_px) * static_cast<size_t>(lens.height_px));
    for (size_t i = 0; i < rgb_.size(); ++i) rgb_[i] = static_cast<uint8_t>(i / 1000);
    image_ = RgbView{rgb_.data(), lens.width_px, lens.height_px, 3 * lens.width_px};
    damaged_ = image_;
    damaged_.format = PixelFormat::kMjpeg;
    damaged_.planes[0] = {jpeg_.data(), 0};
    damaged_.bytes_used = jpeg_.size();
    Prediction prediction;
    prediction.pose.time = Time(std::chrono::milliseconds(850));
    predictions_.push(prediction);
  }

  void push_images(Time time, bool with_damaged) {
    for (int camera = 0; camera < kCameraCount; ++camera) {
      if (camera == kDamagedCamera && !with_damaged) continue;
      drivers::Frame frame;
      frame.camera = camera;
      frame.time = time;
      frame.buffer = {lender_, 0, camera == kDamagedCamera ? damaged_ : image_};
      frames_.push(std::move(frame));
    }
  }

  const std::shared_ptr<Lender> lender_ = std::make_shared<Lender>();
  std::vector<uint8_t> rgb_;
  const std::vector<uint8_t> jpeg_{0xFF, 0xD8, 1, 2, 3, 4, 0xFF, 0xD9};
  ImageView image_;
  ImageView damaged_;
};

}  // namespace bevloc::firmware
