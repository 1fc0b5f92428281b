#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "common/number_text.h"
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

/// The number N of Kalibr's key "camN".
std::optional<int> number_in(std::string_view key) {
  constexpr std::string_view kPrefix = "cam";
  if (!key.starts_with(kPrefix)) return std::nullopt;
  return parse_number<int>(key.substr(kPrefix.size()));
}

/// The key of the camera to which T_cn_cnm1 of the camera `index` is relative: "cam2" for "cam3",
/// wherever the file has it. For keys of another form, it is the camera before in the file.
std::string key_before(const std::vector<std::pair<std::string, ForeignNode>>& entries,
                       size_t index) {
  const auto& [key, camera] = entries[index];
  const std::optional<int> number = number_in(key);
  if (number.value_or(static_cast<int>(index)) == 0) {
    camera.at("T_cn_cnm1").reject("the first camera of the chain", "a camera before it");
  }
  if (!number) return entries[index - 1].first;
  return fmt::format("cam{}", *number - 1);
}

/// Gives each camera of a chain a name that no other one has: the word of its topic, or its key if
/// it has no topic or if an earlier camera has that name. If this key is already the
/// name of another camera, that camera gets its own key, too.
class ChainNames {
 public:
  explicit ChainNames(const std::vector<std::pair<std::string, ForeignNode>>& entries) {
    for (const auto& [key, camera] : entries) {
      const bool is_free = keys_.emplace(name_from_topic(key, camera), key).second;
      if (!is_free) use_key(key);
    }
  }

  /// The names by key.
  std::map<std::string, std::string> by_key() const {
    std::map<std::string, std::string> names;
    for (const auto& [name, key] : keys_) names.emplace(key, name);
    return names;
  }

 private:
  void use_key(const std::string& key) {
    const auto [held, is_free] = keys_.emplace(key, key);
    if (is_free) return;
    const std::string holder = std::exchange(held->second, key);
    use_key(holder);
  }

  std::map<std::string, std::string> keys_;  ///< by name
};

}  // namespace

std::vector<ImportedCamera> read_kalibr(const ForeignNode& document) {
  const auto entries = document.entries();
  const auto names = ChainNames(entries).by_key();
  std::vector<ImportedCamera> cameras;
  for (size_t i = 0; i < entries.size(); ++i) {
    const auto& [key, camera] = entries[i];
    ImportedCamera imported{names.at(key), camera.place(), intrinsics_of(camera)};
    if (camera.has("T_cam_imu")) {
      imported.mounting = {"imu", transform_at(camera, "T_cam_imu").inverse()};
    } else if (camera.has("T_imu_cam")) {
      imported.mounting = {"imu", transform_at(camera, "T_imu_cam")};
    } else if (camera.has("T_cn_cnm1")) {
      const std::string before = key_before(entries, i);
      const auto parent = names.find(before);
      if (parent == names.end()) {
        camera.at("T_cn_cnm1")
            .reject(fmt::format("no {} in the file", before),
                    "the camera to which this transform is relative");
      }
      imported.mounting = {parent->second, transform_at(camera, "T_cn_cnm1").inverse(), true};
    }
    cameras.push_back(std::move(imported));
  }
  return cameras;
}

}  // namespace bevloc::calibration_import
