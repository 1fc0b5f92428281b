#include "pipeline/calibration/rig_check.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <Eigen/LU>
#include <fmt/format.h>

#include "common/se2.h"

namespace bevloc {
namespace {

constexpr std::string_view kRotationKey = "rotation_wxyz";

/// The direction that each camera's name states, counted to the left from the vehicle's x axis.
constexpr std::array<double, kCameraCount> kNamedAzimuthDeg = {60, 0, -60, 120, 180, -120};
/// The cameras from right to left: back_right, front_right, front, front_left, back_left, back.
constexpr std::array<int, kCameraCount> kRightToLeft = {5, 2, 1, 0, 3, 4};

double azimuth_deg(const CameraModel& camera) {
  const Eigen::Vector3d axis = camera.vehicle_from_camera.rotation.col(2);
  return degrees(std::atan2(axis.y(), axis.x()));
}

/// The equivalent angle with the least magnitude.
double turned_deg(double angle_deg) {
  return std::remainder(angle_deg, 360.0);
}

/// The distance from the principal point to the farthest corner, in focal lengths.
double farthest_corner(const Intrinsics& camera) {
  double farthest = 0.0;
  for (const double x_px : {0.0, camera.width_px - 1.0}) {
    for (const double y_px : {0.0, camera.height_px - 1.0}) {
      farthest = std::max(farthest, std::hypot((x_px - camera.cx_px) / camera.fx_px,
                                               (y_px - camera.cy_px) / camera.fy_px));
    }
  }
  return farthest;
}

/// Whether the distance from the principal point grows with the angle up to the farthest corner or
/// kWidestFisheye_rad, and no larger angle comes back into the image.
bool grows_with_angle(const Intrinsics& fisheye) {
  constexpr int kSteps = 160;
  const double farthest = farthest_corner(fisheye);
  double before = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    const double angle = Intrinsics::kWidestFisheye_rad * i / kSteps;
    const auto pixel = fisheye.project({std::sin(angle), 0.0, std::cos(angle)});
    const bool is_beyond_image = before >= farthest;
    if (!pixel && is_beyond_image) continue;
    const double distance = pixel ? (pixel->x() - fisheye.cx_px) / fisheye.fx_px : -1.0;
    if (distance <= (is_beyond_image ? farthest : before)) return false;
    before = std::max(before, distance);
  }
  return true;
}

/// Whether every pixel has its own ray. Each ray must project back to its pixel, and the pixels to
/// the right and below must have rays to the right and below.
bool is_one_to_one(const Intrinsics& camera) {
  if (camera.lens == Lens::kFisheye) return grows_with_angle(camera);
  constexpr int kSteps = 16;
  constexpr double kTolerancePx = 0.01;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d pixel((camera.width_px - 1.0) * i / kSteps,
                                  (camera.height_px - 1.0) * j / kSteps);
      const Eigen::Vector3d ray = camera.ray(pixel);
      const auto again = camera.project(ray);
      if (!again || !((*again - pixel).norm() < kTolerancePx)) return false;
      Eigen::Matrix2d change;
      change.col(0) = (camera.ray(pixel + Eigen::Vector2d::UnitX()) - ray).head<2>();
      change.col(1) = (camera.ray(pixel + Eigen::Vector2d::UnitY()) - ray).head<2>();
      if (!(change.determinant() > 0.0)) return false;
    }
  }
  return true;
}

std::optional<RigMistake> find_in_image_size(int index, const Intrinsics& camera) {
  constexpr int kMostColumnsPerRow = 40;
  const auto [least_px, most_px] = std::minmax(camera.width_px, camera.height_px);
  if (least_px >= kLeastImageSide_px && most_px <= kMostImageSide_px &&
      camera.width_px <= kMostColumnsPerRow * camera.height_px) {
    return std::nullopt;
  }
  return RigMistake{index, false, "image_size_px",
                    fmt::format("images of {} x {} pixels", camera.width_px, camera.height_px),
                    fmt::format("sides of {} to {} pixels, and at least one row for {} columns",
                                kLeastImageSide_px, kMostImageSide_px, kMostColumnsPerRow)};
}

std::optional<RigMistake> find_in_intrinsics(int index, const Intrinsics& camera) {
  if (auto mistake = find_in_image_size(index, camera)) return mistake;
  constexpr double kLeast = 0.05;
  constexpr double kMost = 6.0;
  for (const auto& [key, focal_px] :
       {std::pair("fx_px", camera.fx_px), std::pair("fy_px", camera.fy_px)}) {
    if (focal_px >= kLeast * camera.width_px && focal_px <= kMost * camera.width_px) continue;
    return RigMistake{
        index, false, key, fmt::format("a focal length of {:g} pixels", focal_px),
        fmt::format("{:g} to {:g} for an image of {} columns", kLeast * camera.width_px,
                    kMost * camera.width_px, camera.width_px)};
  }
  if (const double ratio = camera.fy_px / camera.fx_px; ratio < 0.5 || ratio > 2.0) {
    return RigMistake{index, false, "fy_px", fmt::format("{:g} times fx_px", ratio),
                      "0.5 to 2 times fx_px"};
  }
  for (const auto& [key, found_px, size_px] :
       {std::tuple("cx_px", camera.cx_px, camera.width_px),
        std::tuple("cy_px", camera.cy_px, camera.height_px)}) {
    if (found_px >= -0.5 * size_px && found_px <= 1.5 * size_px) continue;
    return RigMistake{index, false, key, fmt::format("a principal point at {:g}", found_px),
                      fmt::format("{:g} to {:g} for an image of {} x {}", -0.5 * size_px,
                                  1.5 * size_px, camera.width_px, camera.height_px)};
  }
  if (is_one_to_one(camera)) return std::nullopt;
  return RigMistake{index, false, "distortion",
                    "a distortion that is not monotonic within the image",
                    "one that gives every pixel its own ray"};
}

std::optional<RigMistake> find_in_mounting(int index, const Se3& vehicle_from_camera) {
  constexpr double kLowest_m = 0.1;
  constexpr double kHighest_m = 6.0;
  constexpr double kMostUp_deg = 30.0;
  constexpr double kMostDown_deg = 60.0;
  constexpr double kMostRoll_deg = 15.0;
  const double height_m = vehicle_from_camera.translation_m.z();
  if (!(height_m >= kLowest_m && height_m <= kHighest_m)) {
    return RigMistake{index, true, "translation_m",
                      fmt::format("a camera {:g} m above the ground", height_m),
                      fmt::format("{:g} to {:g} m", kLowest_m, kHighest_m)};
  }
  const Eigen::Matrix3d& rotation = vehicle_from_camera.rotation;
  const double up_deg = degrees(std::asin(std::clamp(rotation(2, 2), -1.0, 1.0)));
  if (!(up_deg >= -kMostDown_deg && up_deg <= kMostUp_deg)) {
    return RigMistake{index, true, std::string(kRotationKey),
                      fmt::format("an optical axis {:.1f} degrees above the horizon", up_deg),
                      fmt::format("{:g} to {:g} degrees", -kMostDown_deg, kMostUp_deg)};
  }
  // The roll is 0 if the camera's x axis is level and its y axis points down.
  const double roll_deg = degrees(std::atan2(rotation(2, 0), -rotation(2, 1)));
  if (!(std::abs(roll_deg) <= kMostRoll_deg)) {
    return RigMistake{
        index, true, std::string(kRotationKey),
        fmt::format("a camera rolled by {:.1f} degrees about its optical axis", roll_deg),
        fmt::format("a roll of at most {:g} degrees", kMostRoll_deg)};
  }
  return std::nullopt;
}

std::optional<RigMistake> find_in_direction(int index, const CameraModel& camera) {
  constexpr double kTolerance_deg = 55.0;
  const double found_deg = azimuth_deg(camera);
  const double named_deg = kNamedAzimuthDeg[index];
  if (std::abs(turned_deg(found_deg - named_deg)) <= kTolerance_deg) return std::nullopt;
  return RigMistake{
      index, true, std::string(kRotationKey),
      fmt::format("an optical axis {:.1f} degrees to the left of forward", found_deg),
      fmt::format("{:g} to {:g} degrees for a camera named {}", named_deg - kTolerance_deg,
                  named_deg + kTolerance_deg, kCameraNames[index])};
}

std::optional<RigMistake> find_in_order(const Rig& rig) {
  constexpr double kLeastApart_deg = 10.0;
  for (size_t i = 0; i < kRightToLeft.size(); ++i) {
    const int right = kRightToLeft[i];
    const int left = kRightToLeft[(i + 1) % kRightToLeft.size()];
    const double right_deg = azimuth_deg(rig.cameras[right]);
    const double left_deg = azimuth_deg(rig.cameras[left]);
    if (turned_deg(left_deg - right_deg) >= kLeastApart_deg) continue;
    return RigMistake{
        left, true, std::string(kRotationKey),
        fmt::format("optical axes {:.1f} degrees ({}) and {:.1f} degrees ({}) to the left of "
                    "forward",
                    left_deg, kCameraNames[left], right_deg, kCameraNames[right]),
        fmt::format("{} at least {:g} degrees to the left of {}", kCameraNames[left],
                    kLeastApart_deg, kCameraNames[right])};
  }
  return std::nullopt;
}

}  // namespace

std::optional<RigMistake> find_mistake(const Rig& rig) {
  for (int i = 0; i < kCameraCount; ++i) {
    const CameraModel& camera = rig.cameras[i];
    if (auto mistake = find_in_intrinsics(i, camera.intrinsics)) return mistake;
    if (auto mistake = find_in_mounting(i, camera.vehicle_from_camera)) return mistake;
    if (auto mistake = find_in_direction(i, camera)) return mistake;
  }
  return find_in_order(rig);
}

}  // namespace bevloc
