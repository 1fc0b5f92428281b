#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "pipeline/calibration/import/readers.h"

namespace bevloc::calibration_import {
namespace {

ImportedCamera camera_from(const ForeignNode& entry, const std::string& channel) {
  ImportedCamera camera{channel, entry.place(), {}};
  const ForeignNode matrix = entry.at("camera_intrinsic");
  std::vector<double> rows;
  for (const ForeignNode& row : matrix.items()) {
    for (const double number : row.numbers(3)) rows.push_back(number);
  }
  if (rows.size() != 9) matrix.reject(fmt::format("{} numbers", rows.size()), "3 rows of 3");
  set_camera_matrix(rows, matrix.place(), camera.intrinsics);
  // nuImages has distorted pictures. Its fifth and sixth coefficients are k3 and k4.
  if (entry.has("camera_distortion")) {
    const ForeignNode distortion = entry.at("camera_distortion");
    auto coefficients = distortion.numbers();
    if (coefficients.size() == 6) coefficients.resize(8, 0.0);
    set_pinhole_distortion(coefficients, distortion.place(), camera.intrinsics);
  }
  const ForeignNode rotation = entry.at("rotation");
  const auto translation = entry.at("translation").numbers(3);
  camera.mounting = {"vehicle",
                     {rotation_from_wxyz(rotation.numbers(4), rotation.place()),
                      {translation[0], translation[1], translation[2]}}};
  return camera;
}

bool is_same(const ImportedCamera& a, const ImportedCamera& b) {
  const Se3& pose_a = a.mounting->parent_from_camera;
  const Se3& pose_b = b.mounting->parent_from_camera;
  return a.intrinsics == b.intrinsics && pose_a.rotation == pose_b.rotation &&
         pose_a.translation_m == pose_b.translation_m;
}

}  // namespace

std::vector<ImportedCamera> read_nuscenes(const ForeignNode& calibrated_sensors,
                                          const ForeignNode& sensors,
                                          const std::vector<std::string>& tokens) {
  std::map<std::string, std::string> channels;
  for (const ForeignNode& sensor : sensors.items()) {
    if (sensor.at("modality").text() != "camera") continue;
    channels[sensor.at("token").text()] = sensor.at("channel").text();
  }
  std::vector<ImportedCamera> cameras;
  std::set<std::string> unknown_tokens(tokens.begin(), tokens.end());
  for (const ForeignNode& entry : calibrated_sensors.items()) {
    const auto channel = channels.find(entry.at("sensor_token").text());
    if (channel == channels.end()) continue;
    const std::string token = entry.at("token").text();
    if (!tokens.empty() && std::ranges::find(tokens, token) == tokens.end()) continue;
    unknown_tokens.erase(token);
    ImportedCamera camera = camera_from(entry, channel->second);
    const auto same_name = [&](const auto& other) { return other.name == camera.name; };
    const auto earlier = std::ranges::find_if(cameras, same_name);
    if (earlier == cameras.end()) {
      cameras.push_back(std::move(camera));
    } else if (!is_same(*earlier, camera)) {
      refuse(
          camera.place, fmt::format("another calibration of {}", camera.name),
          fmt::format("one; choose one for each camera with --token, such as --token {}", token));
    }
  }
  if (!unknown_tokens.empty()) {
    refuse("--token", *unknown_tokens.begin(), "the token of a camera in calibrated_sensor.json");
  }
  return cameras;
}

}  // namespace bevloc::calibration_import
