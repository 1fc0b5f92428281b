#include "sim/faults/picture_faults.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "common/se2.h"
#include "sim/faults/fault_table.h"
#include "sim/faults/lens_dirt.h"
#include "sim/sim_rig.h"

namespace bevloc::sim {
namespace {

/// A picture with a pattern of mean 100.
RgbImage pattern() {
  RgbImage image(64, 36);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<uint8_t>(60 + 80 * ((i / 3 + i / 192) % 2));
  }
  return image;
}

double mean(const RgbImage& image) {
  return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) /
         static_cast<double>(image.pixels.size());
}

int contrast(const RgbImage& image) {
  const auto [low, high] = std::minmax_element(image.pixels.begin(), image.pixels.end());
  return *high - *low;
}

RgbImage with(FaultKind kind, uint64_t seed, double brightness_or_strength) {
  Fault fault = make_fault(kind);
  fault.amounts.brightness = brightness_or_strength;
  fault.amounts.strength = brightness_or_strength;
  RgbImage image = pattern();
  disturb_light(image, std::vector{fault}, seed);
  return image;
}

TEST(PictureFaults, ADarkPictureShowsNoiseOnly) {
  const RgbImage dark = with(FaultKind::kCameraDark, 1, 0.0);
  EXPECT_LT(mean(dark), 2.0);
  EXPECT_LT(contrast(dark), 10);
  EXPECT_NE(dark.pixels, with(FaultKind::kCameraDark, 2, 0.0).pixels) << "not frozen";
  EXPECT_EQ(dark.pixels, with(FaultKind::kCameraDark, 1, 0.0).pixels);
  EXPECT_NEAR(mean(with(FaultKind::kCameraDark, 1, 0.3)), 30.0, 1.0);
}

TEST(PictureFaults, ABlindedPictureIsBrightAndFlatAndHalfBlindedOnlyInParts) {
  const RgbImage blinded = with(FaultKind::kCameraBlinded, 1, 1.0);
  EXPECT_GT(mean(blinded), 245.0);
  EXPECT_LT(contrast(blinded), 20);
  const RgbImage half = with(FaultKind::kCameraBlinded, 1, 0.2);
  EXPECT_GT(mean(half), mean(pattern()) + 5.0);
  EXPECT_GT(contrast(half), 60);
}

TEST(PictureFaults, DirtCoversItsShareAndStaysInItsPlace) {
  for (const double share : {0.1, 0.4, 0.8}) {
    const LensDirt dirt(64, 36, share, 7);
    EXPECT_GE(dirt.covered(), share);
    EXPECT_LT(dirt.covered(), share + 0.1);
  }
  const LensDirt dirt(64, 36, 0.4, 7);
  RgbImage first = pattern();
  dirt.cover(first);
  RgbImage second = pattern();
  dirt.cover(second);
  EXPECT_EQ(first.pixels, second.pixels);
  const RgbImage clean = pattern();
  size_t changed = 0;
  for (size_t i = 0; i < clean.pixels.size(); ++i) changed += first.pixels[i] != clean.pixels[i];
  EXPECT_GT(changed, clean.pixels.size() / 3);
  EXPECT_LT(changed, clean.pixels.size());
}

TEST(PictureFaults, SwappedCamerasShowEachOthersView) {
  Fault swapped = make_fault(FaultKind::kCameraSwapped);
  swapped.camera = 1;
  swapped.other_camera = 4;
  const std::vector active = {swapped};
  EXPECT_EQ(source_camera(1, active), 4);
  EXPECT_EQ(source_camera(4, active), 1);
  EXPECT_EQ(source_camera(2, active), 2);
}

TEST(PictureFaults, SwapsActOneAfterTheOther) {
  Fault first = make_fault(FaultKind::kCameraSwapped);
  first.camera = 1;
  first.other_camera = 4;
  Fault second = first;
  second.other_camera = 0;
  const std::vector active = {first, second};
  EXPECT_EQ(source_camera(0, active), 4);
  EXPECT_EQ(source_camera(1, active), 0);
  EXPECT_EQ(source_camera(4, active), 1);
}

constexpr double kTurn_deg = 10.0;

CameraModel turned(const CameraModel& camera, double FaultAmounts::*angle) {
  Fault fault = make_fault(FaultKind::kCameraTurned);
  fault.amounts.*angle = kTurn_deg;
  return disturbed(camera, std::vector{fault});
}

/// The camera's right (column 0), down (1) or forward (2) axis in the vehicle frame.
Eigen::Vector3d axis_of(const CameraModel& camera, int column) {
  return camera.vehicle_from_camera.rotation.col(column);
}

double azimuth_rad(const CameraModel& camera) {
  const Eigen::Vector3d forward = axis_of(camera, 2);
  return std::atan2(forward.y(), forward.x());
}

double elevation_rad(const CameraModel& camera) {
  return std::asin(axis_of(camera, 2).z());
}

// The cameras of the nominal rig are not tilted.
TEST(PictureFaults, EveryTurnedCameraLooksToItsLeftDownOrTiltsToItsRight) {
  const double turn_rad = radians(kTurn_deg);
  const Rig rig = nominal_rig();
  for (size_t i = 0; i < rig.cameras.size(); ++i) {
    SCOPED_TRACE(kCameraNames[i]);
    const CameraModel& camera = rig.cameras[i];
    const CameraModel to_left = turned(camera, &FaultAmounts::yaw_deg);
    EXPECT_NEAR(wrap_angle(azimuth_rad(to_left) - azimuth_rad(camera)), turn_rad, 1e-9);
    EXPECT_NEAR(elevation_rad(to_left), elevation_rad(camera), 1e-9);
    const CameraModel down = turned(camera, &FaultAmounts::pitch_deg);
    EXPECT_NEAR(wrap_angle(azimuth_rad(down) - azimuth_rad(camera)), 0.0, 1e-9);
    EXPECT_NEAR(elevation_rad(down), elevation_rad(camera) - turn_rad, 1e-9);
    const CameraModel tilted = turned(camera, &FaultAmounts::roll_deg);
    EXPECT_NEAR((axis_of(tilted, 2) - axis_of(camera, 2)).norm(), 0.0, 1e-9);
    EXPECT_NEAR(axis_of(tilted, 0).dot(axis_of(camera, 1)), std::sin(turn_rad), 1e-9)
        << "its right side is lower";
    EXPECT_EQ(tilted.vehicle_from_camera.translation_m, camera.vehicle_from_camera.translation_m);
  }
}

TEST(PictureFaults, AMovedCameraKeepsItsDirection) {
  const CameraModel front = nominal_rig().cameras[1];
  Fault moved = make_fault(FaultKind::kCameraMoved);
  moved.amounts.y_m = 0.2;
  const CameraModel camera = disturbed(front, std::vector{moved});
  EXPECT_EQ(camera.vehicle_from_camera.rotation, front.vehicle_from_camera.rotation);
  EXPECT_NEAR(
      camera.vehicle_from_camera.translation_m.y() - front.vehicle_from_camera.translation_m.y(),
      0.2, 1e-12);
}

}  // namespace
}  // namespace bevloc::sim
