// One localization, made by hand, for the tests of the live page.
#pragma once

#include <vector>

#include "drivers/camera/frame_pool.h"
#include "firmware/stages/vision_stage.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::firmware {

/// Six grey images of 64 x 36 pixels, five hypotheses per axis and an empty mask.
struct HandMadeLocalization {
  HandMadeLocalization() {
    for (CameraModel& camera : rig.cameras) {
      camera.intrinsics.width_px = kWidth_px;
      camera.intrinsics.height_px = kHeight_px;
      camera.intrinsics.fx_px = camera.intrinsics.fy_px = 50.0;
      camera.intrinsics.cx_px = 32.0;
      camera.intrinsics.cy_px = 18.0;
      camera.vehicle_from_camera.rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
      camera.vehicle_from_camera.translation_m = {0.0, 0.0, 1.5};
    }
    for (int camera = 0; camera < kCameraCount; ++camera) {
      frameset.frames[camera].camera = camera;
      frameset.frames[camera].buffer = pool->borrow();
      RgbImage& image = pool->image(frameset.frames[camera].buffer);
      std::fill(image.pixels.begin(), image.pixels.end(), static_cast<uint8_t>(10 * camera + 10));
      frameset.present.set(camera);
      report.present.set(camera);
    }
    frameset.time = Time(std::chrono::seconds(1));
    report.had_prior = true;
    report.prior = {5.0, 1.0, 0.0};
    solution.evidence = Evidence::kGood;
    solution.correction = {0.5, -0.25, radians(1.0)};
    solution.score = 0.75;
    solution.x_probability = {0.0F, 0.25F, 0.5F, 0.25F, 0.0F};
    solution.y_probability = solution.x_probability;
    solution.yaw_probability = solution.x_probability;
    report.match = solution;
  }

  VisionSnapshot snapshot() {
    return {frameset,   report, motions,       solution, SearchRange::kTracking,
            hypotheses, {},     perceived_mask};
  }

  static constexpr int kWidth_px = 64;
  static constexpr int kHeight_px = 36;
  Rig rig;
  std::shared_ptr<drivers::FramePool> pool =
      drivers::FramePool::create(kCameraCount, kWidth_px, kHeight_px);
  drivers::Frameset frameset;
  VisionReport report;
  CameraMotions motions{};
  SolverResult solution;
  HypothesisGrid hypotheses{{0.4, 0.2}, {0.4, 0.2}, {radians(0.4), radians(0.2)}};
  std::vector<float> mask = std::vector<float>(kRasterChannels * 400 * 200, -5.0F);
  int masks_computed = 0;
  std::function<std::span<const float>()> perceived_mask = [this] {
    ++masks_computed;
    return std::span<const float>(mask);
  };
};

}  // namespace bevloc::firmware
