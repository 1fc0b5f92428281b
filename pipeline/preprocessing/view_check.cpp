#include "pipeline/preprocessing/view_check.h"

#include <array>
#include <cassert>

#include <fmt/format.h>

#include "pipeline/preprocessing/network_camera.h"

namespace bevloc {
namespace {

constexpr int kRefusedBelow_percent = 25;
constexpr int kWarnedBelow_percent = 90;

/// The cameras that show less than this, such as "front 61 %, back 80 %"; empty if none does.
std::string cameras_below(int limit_percent, const std::array<double, kCameraCount>& shares) {
  std::string text;
  for (size_t i = 0; i < kCameraCount; ++i) {
    if (100.0 * shares[i] >= limit_percent) continue;
    // Rounded down, so that the text never shows the limit itself.
    text += fmt::format("{}{} {} %", text.empty() ? "" : ", ", kCameraNames[i],
                        static_cast<int>(100.0 * shares[i]));
  }
  return text;
}

std::string found_part(const std::string& cameras) {
  return fmt::format("cameras that show only a part of the network image below the horizon ({})",
                     cameras);
}

}  // namespace

double shown_share(const CameraModel& camera) {
  const Intrinsics network = network_camera(camera).intrinsics;
  const Eigen::Vector3d up = camera.vehicle_from_camera.rotation.row(2);
  int below = 0;
  int shown = 0;
  for (int v = 0; v < kNetworkHeightPx; ++v) {
    for (int u = 0; u < kNetworkWidthPx; ++u) {
      if (up.dot(network.ray({u, v})) >= 0.0) continue;
      ++below;
      shown += shown_place(camera, network, {u, v}) ? 1 : 0;
    }
  }
  assert(below > 0 && "a rig with such a roll has a mistake (rig_check.h)");
  return static_cast<double>(shown) / below;
}

Result<std::string> check_views(const Rig& rig, const std::string& file) {
  std::array<double, kCameraCount> shares{};
  for (size_t i = 0; i < kCameraCount; ++i) shares[i] = shown_share(rig.cameras[i]);
  if (const auto useless = cameras_below(kRefusedBelow_percent, shares); !useless.empty()) {
    return fail(
        "{}: found {}, wanted at least {} %; correct rotation_wxyz, the intrinsics or own_body_px, "
        "or aim the cameras nearer to the horizon",
        file, found_part(useless), kRefusedBelow_percent);
  }
  const std::string poor = cameras_below(kWarnedBelow_percent, shares);
  if (poor.empty()) return "";
  return fmt::format("{}: found {}, wanted at least {} %, or the pose is less accurate", file,
                     found_part(poor), kWarnedBelow_percent);
}

}  // namespace bevloc
