#include "pipeline/calibration/import/import_rig.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "pipeline/calibration/import/camera_names.h"
#include "pipeline/calibration/import/readers.h"
#include "pipeline/calibration/import/rig_builder.h"
#include "pipeline/calibration/rig_yaml.h"

namespace bevloc {
namespace {

using calibration_import::CameraSource;
using calibration_import::ForeignNode;
using calibration_import::ImportedCamera;
using calibration_import::ImportError;
using calibration_import::refuse;

bool is_kalibr(const ForeignNode& document) {
  if (!document.is_map()) return false;
  const auto entries = document.entries();
  return !entries.empty() && std::ranges::all_of(entries, [](const auto& entry) {
    return entry.second.has("camera_model");
  });
}

bool is_list_with(const ForeignNode& document, std::string_view key) {
  if (!document.is_list()) return false;
  const auto items = document.items();
  return !items.empty() && items.front().has(key);
}

/// Collects the files. A format with several files is read after all files have been seen.
class Collector {
 public:
  explicit Collector(const RigImportOptions& options) : options_(options) {}

  void add(const ForeignFile& file) {
    const std::filesystem::path path(file.name);
    if (path.filename() == "cameras.txt") {
      keep(colmap_cameras_, &file, file);
    } else if (path.filename() == "images.txt") {
      keep(colmap_images_, &file, file);
    } else {
      add_document(file, path.stem().string());
    }
  }

  std::vector<ImportedCamera> finish() {
    if (calibrated_ || sensors_) {
      if (!calibrated_)
        refuse(sensors_->place(), "sensor.json alone", "calibrated_sensor.json too");
      if (!sensors_)
        refuse(calibrated_->place(), "calibrated_sensor.json alone", "sensor.json too");
      take(calibration_import::read_nuscenes(*calibrated_, *sensors_, options_.tokens));
    } else if (!options_.tokens.empty()) {
      refuse("--token", options_.tokens.front(), "it only with files of nuScenes");
    }
    if (colmap_images_ && !colmap_cameras_) {
      refuse(colmap_images_->name, "images.txt alone", "cameras.txt too");
    }
    if (colmap_cameras_) {
      take(calibration_import::read_colmap(colmap_cameras_->text, colmap_cameras_->name,
                                           colmap_images_ ? colmap_images_->text : std::string(),
                                           colmap_images_ ? colmap_images_->name : std::string()));
    }
    return std::move(cameras_);
  }

 private:
  void take(std::vector<ImportedCamera> cameras) {
    std::ranges::move(cameras, std::back_inserter(cameras_));
  }

  template <typename Kept, typename Value>
  static void keep(Kept& kept, const Value& value, const ForeignFile& file) {
    if (kept) refuse(file.name, "a second file of its kind", "one");
    kept = value;
  }

  void add_document(const ForeignFile& file, const std::string& stem) {
    const ForeignNode document = ForeignNode::parse(file.text, file.name);
    if (is_list_with(document, "camera_intrinsic")) {
      keep(calibrated_, document, file);
    } else if (is_list_with(document, "channel")) {
      keep(sensors_, document, file);
    } else if (document.has("distortion_model") && document.has("camera_matrix")) {
      cameras_.push_back(calibration_import::read_camera_info(document, stem));
    } else if (is_kalibr(document)) {
      // OpenVINS writes chains with the header of OpenCV.
      take(calibration_import::read_kalibr(document));
    } else if (file.text.starts_with("%YAML:")) {
      cameras_.push_back(calibration_import::read_opencv(document, stem));
    } else {
      refuse(file.name, "no known calibration",
             "a camchain of Kalibr, a FileStorage of OpenCV (%YAML:1.0), a camera_info of ROS, "
             "calibrated_sensor.json and sensor.json of nuScenes, or cameras.txt of COLMAP");
    }
  }

  const RigImportOptions& options_;
  std::vector<ImportedCamera> cameras_;
  std::optional<ForeignNode> calibrated_;
  std::optional<ForeignNode> sensors_;
  const ForeignFile* colmap_cameras_ = nullptr;
  const ForeignFile* colmap_images_ = nullptr;
};

/// Removes the byte order mark with which some editors begin a file.
std::vector<ForeignFile> without_byte_order_marks(std::vector<ForeignFile> files) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  for (ForeignFile& file : files) {
    if (file.text.starts_with(kMark)) file.text.erase(0, kMark.size());
  }
  return files;
}

/// Replaces the place in a message of parse_rig() by the place that the camera comes from, because
/// there is no rig file yet.
std::string with_source(const std::string& message,
                        const std::array<CameraSource, kCameraCount>& sources) {
  constexpr std::string_view kKey = ": cameras.";
  const size_t key = message.find(kKey);
  if (key == std::string::npos) return message;
  const std::string rest = message.substr(key + kKey.size());
  for (size_t i = 0; i < kCameraCount; ++i) {
    if (!rest.starts_with(fmt::format("{}.", kCameraNames[i]))) continue;
    const bool is_place = rest.find(".vehicle_from_camera.") < rest.find(": ");
    return fmt::format("{}: {}", is_place ? sources[i].extrinsics : sources[i].intrinsics, rest);
  }
  return message;
}

}  // namespace

Result<ImportedRig> import_rig(const std::vector<ForeignFile>& files,
                               const RigImportOptions& options) {
  const std::vector<ForeignFile> unmarked = without_byte_order_marks(files);
  try {
    Collector collector(options);
    for (const ForeignFile& file : unmarked) collector.add(file);
    auto cameras = collector.finish();
    if (cameras.empty()) {
      refuse(files.empty() ? "calib import" : files.front().name, "no camera",
             options.tokens.empty() ? "at least one" : "one with the token of --token");
    }
    calibration_import::name_after_files(options.our_names, cameras);
    auto built = calibration_import::build_rig(std::move(cameras), options);
    // The rig must pass the checks of a rig file.
    const auto rig = parse_rig(format_rig(built.rig), "imported rig");
    if (!rig) return tl::unexpected(Error{with_source(rig.error().message, built.sources)});
    return ImportedRig{*rig, std::move(built.notes)};
  } catch (const ImportError& error) {
    return tl::unexpected(Error{error.message});
  } catch (const YAML::Exception& error) {
    return fail("line {}: found {}, wanted YAML or JSON", error.mark.line + 1, error.msg);
  }
}

Result<std::map<std::string, std::string>> parse_camera_names(
    const std::vector<std::string>& pairs) {
  std::map<std::string, std::string> our_names;
  for (const std::string& pair : pairs) {
    const size_t equals = pair.find('=');
    if (equals == std::string::npos) {
      return fail("--map-camera: found {}, wanted THEIRS=OURS, such as cam0=front", pair);
    }
    const auto [earlier, is_new] =
        our_names.emplace(pair.substr(0, equals), pair.substr(equals + 1));
    if (!is_new) {
      return fail("--map-camera: found {} after {}={}, wanted each camera once", pair,
                  earlier->first, earlier->second);
    }
  }
  return our_names;
}

Result<std::map<std::string, Se3>> parse_extrinsics(const std::string& text,
                                                    const std::string& name) {
  try {
    std::map<std::string, Se3> result;
    for (const auto& [frame, entry] : ForeignNode::parse(text, name).entries()) {
      const bool known = frame == "imu" || frame == "world" || calibration_import::is_ours(frame);
      if (!known) entry.reject(frame, "imu, world or one of our cameras");
      for (const auto& [key, value] : entry.entries()) {
        if (key == "translation_m" || key == "rotation_wxyz") continue;
        value.reject("an unknown key", "translation_m and rotation_wxyz only");
      }
      const ForeignNode rotation = entry.at("rotation_wxyz");
      const auto at = entry.at("translation_m").numbers(3);
      result[frame] = {
          calibration_import::rotation_from_wxyz(rotation.numbers(4), rotation.place()),
          {at[0], at[1], at[2]}};
    }
    return result;
  } catch (const ImportError& error) {
    return tl::unexpected(Error{error.message});
  } catch (const YAML::Exception& error) {
    return fail("{}:{}: found {}, wanted YAML", name, error.mark.line + 1, error.msg);
  }
}

}  // namespace bevloc
