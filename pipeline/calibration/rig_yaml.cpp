#include "pipeline/calibration/rig_yaml.h"

#include <cmath>

#include <Eigen/Geometry>

#include "common/files.h"
#include "pipeline/calibration/rig_check.h"
#include "pipeline/calibration/rig_keys.h"
#include "pipeline/calibration/unit_quaternion.h"

namespace bevloc {
namespace {

constexpr double kMaxPixel = 2.0 * kMostImageSide_px;
constexpr double kMaxDistortion = 10.0;
constexpr double kMaxFromVehicleOriginM = 50.0;

Intrinsics read_intrinsics(YamlMap& yaml) {
  Intrinsics camera;
  const auto size =
      yaml.require_list<int>("image_size_px", 2, between(kLeastImageSide_px, kMostImageSide_px));
  camera.width_px = size[0];
  camera.height_px = size[1];
  camera.fx_px = yaml.require<double>("fx_px", more_than(0.0));
  camera.fy_px = yaml.require<double>("fy_px", more_than(0.0));
  camera.cx_px = yaml.require<double>("cx_px", between(-kMaxPixel, kMaxPixel));
  camera.cy_px = yaml.require<double>("cy_px", between(-kMaxPixel, kMaxPixel));
  camera.lens = yaml.optional_choice("lens", Lens::kPinhole,
                                     {{"pinhole", Lens::kPinhole}, {"fisheye", Lens::kFisheye}});
  const auto distortion =
      yaml.require_list<double>("distortion", 4, between(-kMaxDistortion, kMaxDistortion));
  const bool fisheye = camera.lens == Lens::kFisheye;
  camera.k1 = distortion[0];
  camera.k2 = distortion[1];
  (fisheye ? camera.k3 : camera.p1) = distortion[2];
  (fisheye ? camera.k4 : camera.p2) = distortion[3];
  return camera;
}

/// Reads the corners, which are given as columns and rows in turn.
std::vector<Eigen::Vector2d> read_own_body(YamlMap& yaml) {
  constexpr size_t kLeast = 6;
  std::vector<Eigen::Vector2d> corners;
  if (!yaml.has("own_body_px")) return corners;
  const auto numbers = yaml.require_list<double>("own_body_px", 0, between(-kMaxPixel, kMaxPixel));
  if (numbers.size() < kLeast || numbers.size() % 2 != 0) {
    yaml.reject("own_body_px", fmt::format("{} numbers", numbers.size()),
                "column and row of at least three corners");
    return corners;
  }
  for (size_t i = 0; i < numbers.size(); i += 2) corners.emplace_back(numbers[i], numbers[i + 1]);
  return corners;
}

Se3 read_vehicle_from_camera(YamlMap& yaml) {
  Se3 transform;
  const auto translation = yaml.require_list<double>(
      "translation_m", 3, between(-kMaxFromVehicleOriginM, kMaxFromVehicleOriginM));
  transform.translation_m = {translation[0], translation[1], translation[2]};
  const auto wxyz = yaml.require_list<double>("rotation_wxyz", 4);
  const auto rotation = rotation_from_quaternion(wxyz);
  if (rotation) {
    transform.rotation = *rotation;
  } else {
    yaml.reject("rotation_wxyz", rotation.error().message, "a unit quaternion");
  }
  return transform;
}

/// Writes at most nine decimals, without trailing zeros and without "-0".
std::string format_number(double value) {
  constexpr double kUnit = 1e9;
  return fmt::format("{:.15g}", std::round(value * kUnit) / kUnit + 0.0);
}

template <typename... Numbers>
std::string format_list(Numbers... numbers) {
  const std::array<std::string, sizeof...(numbers)> texts = {format_number(numbers)...};
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string format_camera(const CameraModel& camera) {
  const Intrinsics& k = camera.intrinsics;
  const bool fisheye = k.lens == Lens::kFisheye;
  const Eigen::Vector3d& t = camera.vehicle_from_camera.translation_m;
  Eigen::Quaterniond q(camera.vehicle_from_camera.rotation);
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  std::vector<std::string> body;
  for (const Eigen::Vector2d& corner : camera.own_body_px) {
    body.push_back(format_number(corner.x()));
    body.push_back(format_number(corner.y()));
  }
  return fmt::format(
      "    image_size_px: [{}, {}]\n"
      "{}"
      "    fx_px: {}\n"
      "    fy_px: {}\n"
      "    cx_px: {}\n"
      "    cy_px: {}\n"
      "    distortion: {}\n"
      "{}"
      "    vehicle_from_camera:\n"
      "      translation_m: {}\n"
      "      rotation_wxyz: {}\n",
      k.width_px, k.height_px, fisheye ? "    lens: fisheye\n" : "", format_number(k.fx_px),
      format_number(k.fy_px), format_number(k.cx_px), format_number(k.cy_px),
      format_list(k.k1, k.k2, fisheye ? k.k3 : k.p1, fisheye ? k.k4 : k.p2),
      body.empty() ? "" : fmt::format("    own_body_px: [{}]\n", fmt::join(body, ", ")),
      format_list(t.x(), t.y(), t.z()), format_list(q.w(), q.x(), q.y(), q.z()));
}

}  // namespace

Result<Rig> read_rig(const std::filesystem::path& path) {
  return parse_file(path, parse_rig);
}

Rig read_rig_keys(YamlMap& yaml, RigKeys& keys) {
  Rig rig;
  YamlMap cameras = yaml.require_map("cameras");
  for (size_t i = 0; i < kCameraCount; ++i) {
    keys.intrinsics.push_back(cameras.require_map(kCameraNames[i]));
    keys.mountings.push_back(keys.intrinsics.back().require_map("vehicle_from_camera"));
    rig.cameras[i].intrinsics = read_intrinsics(keys.intrinsics.back());
    rig.cameras[i].own_body_px = read_own_body(keys.intrinsics.back());
    rig.cameras[i].vehicle_from_camera = read_vehicle_from_camera(keys.mountings.back());
  }
  return rig;
}

Result<Rig> parse_rig(const std::string& text, const std::string& name) {
  Result<YamlMap> yaml = YamlMap::parse(text, name);
  if (!yaml) return tl::unexpected(yaml.error());
  RigKeys keys;
  const Rig rig = read_rig_keys(*yaml, keys);
  // Mistakes in what the numbers mean are looked for only in a file whose numbers are all there.
  if (const Status status = yaml->finish(); !status) return tl::unexpected(status.error());
  const std::optional<RigMistake> mistake = find_mistake(rig);
  if (!mistake) return rig;
  std::vector<YamlMap>& maps = mistake->is_mounting ? keys.mountings : keys.intrinsics;
  maps[static_cast<size_t>(mistake->camera)].reject(mistake->key, mistake->found, mistake->wanted);
  return tl::unexpected(yaml->finish().error());
}

std::string format_rig(const Rig& rig) {
  std::string text =
      "# Calibration of the six cameras. Pixel (0, 0) is the centre of the top left pixel;\n"
      "# distortion is k1, k2, p1, p2 as OpenCV names them, of a fisheye k1, k2, k3, k4. Camera "
      "axes: x right, y down,\n"
      "# z forward; vehicle axes: x forward, y left, z up, from the ground under the rear axle.\n"
      "cameras:\n";
  for (size_t i = 0; i < kCameraCount; ++i) {
    text += fmt::format("  {}:\n{}", kCameraNames[i], format_camera(rig.cameras[i]));
  }
  return text;
}

}  // namespace bevloc
