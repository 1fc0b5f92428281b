// A small camera in a small town, for the tests of mock cameras.
#pragma once

#include <memory>

#include "drivers/mock/mock_camera.h"
#include "sim/sim_rig.h"
#include "sim/world/world_generator.h"

namespace bevloc::drivers {

/// One town and one drive, created once per program.
inline const std::shared_ptr<MockScene>& test_scene() {
  static const std::shared_ptr<MockScene> scene = [] {
    constexpr uint64_t kSeed = 5;
    const auto world = std::make_shared<const sim::World>(sim::generate_world(kSeed));
    const auto drive = std::make_shared<const sim::Drive>(*world, kSeed, 30.0);
    return std::make_shared<MockScene>(world, drive, sim::Conditions{}, kSeed);
  }();
  return scene;
}

/// The nominal front camera at 10 Hz, with a tenth of its width and height. All cameras
/// have its view.
inline MockCameraConfig small_front_camera() {
  constexpr int kFront = 1;
  constexpr double kScale = 0.1;
  MockCameraConfig config;
  config.camera = kFront;
  CameraModel camera = sim::nominal_rig().cameras[kFront];
  Intrinsics& intrinsics = camera.intrinsics;
  intrinsics.width_px = static_cast<int>(kScale * intrinsics.width_px);
  intrinsics.height_px = static_cast<int>(kScale * intrinsics.height_px);
  intrinsics.fx_px *= kScale;
  intrinsics.fy_px *= kScale;
  intrinsics.cx_px *= kScale;
  intrinsics.cy_px *= kScale;
  config.true_rig.cameras.fill(camera);
  config.timing.period = std::chrono::milliseconds(100);
  config.timing.exposure = std::chrono::milliseconds(8);
  config.timing.readout = std::chrono::milliseconds(20);
  return config;
}

}  // namespace bevloc::drivers
