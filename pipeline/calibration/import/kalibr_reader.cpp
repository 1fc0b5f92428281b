#include <algorithm>

#include <fmt/format.h>

#include "pipeline/calibration/import/readers.h"

namespace bevloc::calibration_import {
namespace {

/// "/front/image_raw" names the camera "front".
std::string name_from_topic(const std::string& key, const ForeignNode& camera) {
  if (!camera.has("rostopic")) return key;
  const std::string topic = camera.at("rostopic").text();
  const size_t begin = topic.find_first_not_of('/');
  if (begin == std::string::npos) return key;
  return topic.substr(begin, topic.find('/', begin) - begin);
}

Se3 transform_at(const ForeignNode& camera, std::string_view key) {
  std::vector<double> rows;
  const ForeignNode matrix = camera.at(key);
  for (const ForeignNode& row : matrix.items()) {
    for (const double number : row.numbers(4)) rows.push_back(number);
  }
  if (rows.size() != 16) matrix.reject(fmt::format("{} numbers", rows.size()), "4 rows of 4");
  return rigid_from_rows(rows, matrix.place());
}

Intrinsics intrinsics_of(const ForeignNode& camera) {
  const ForeignNode model = camera.at("camera_model");
  if (model.text() != "pinhole") {
    model.reject(model.text(), "pinhole, because bevloc's camera model expresses no other");
  }
  Intrinsics lens;
  const auto focal = camera.at("intrinsics").numbers(4);
  lens.fx_px = focal[0];
  lens.fy_px = focal[1];
  lens.cx_px = focal[2];
  lens.cy_px = focal[3];
  const auto sides = camera.at("resolution").items();
  if (sides.size() != 2) camera.at("resolution").reject("another list", "width and height");
  lens.width_px = sides[0].whole_number(1, kLargestImage_px);
  lens.height_px = sides[1].whole_number(1, kLargestImage_px);
  const ForeignNode distortion = camera.at("distortion_model");
  const std::string kind = distortion.text();
  if (kind == "none") return lens;
  const ForeignNode coefficients = camera.at("distortion_coeffs");
  if (kind == "radtan") {
    set_pinhole_distortion(coefficients.numbers(4), coefficients.place(), lens);
  } else if (kind == "equidistant") {
    set_fisheye_distortion(coefficients.numbers(4), coefficients.place(), lens);
  } else {
    distortion.reject(kind, "radtan, equidistant or none");
  }
  return lens;
}

}  // namespace

std::vector<ImportedCamera> read_kalibr(const ForeignNode& document) {
  std::vector<ImportedCamera> cameras;
  for (const auto& [key, camera] : document.entries()) {
    ImportedCamera imported{name_from_topic(key, camera), camera.place(), intrinsics_of(camera)};
    // Two cameras under one topic would share a name.
    const auto same = [&](const ImportedCamera& other) { return other.name == imported.name; };
    if (std::ranges::any_of(cameras, same)) imported.name = key;
    if (camera.has("T_cam_imu")) {
      imported.mounting = {"imu", transform_at(camera, "T_cam_imu").inverse()};
    } else if (camera.has("T_cn_cnm1")) {
      if (cameras.empty()) camera.at("T_cn_cnm1").reject("a first camera", "a camera before it");
      imported.mounting = {cameras.back().name, transform_at(camera, "T_cn_cnm1").inverse(), true};
    }
    cameras.push_back(std::move(imported));
  }
  return cameras;
}

}  // namespace bevloc::calibration_import
