#include "pipeline/calibration/import/import_rig.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pipeline/calibration/import/readers.h"
#include "pipeline/calibration/rig_yaml.h"

namespace bevloc {
namespace {

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

/// Formats that take several files are read when all have been seen.
class Collector {
 public:
  explicit Collector(const RigImportOptions& options) : options_(options) {}

  void add(const ForeignFile& file) {
    const std::filesystem::path path(file.name);
    if (path.filename() == "cameras.txt") {
      colmap_cameras_ = &file;
    } else if (path.filename() == "images.txt") {
      colmap_images_ = &file;
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

  void add_document(const ForeignFile& file, const std::string& stem) {
    const ForeignNode document = ForeignNode::parse(file.text, file.name);
    if (is_list_with(document, "camera_intrinsic")) {
      calibrated_ = document;
    } else if (is_list_with(document, "channel")) {
      sensors_ = document;
    } else if (document.has("distortion_model") && document.has("camera_matrix")) {
      cameras_.push_back(calibration_import::read_camera_info(document, stem));
    } else if (file.text.starts_with("%YAML:")) {
      cameras_.push_back(calibration_import::read_opencv(document, stem));
    } else if (is_kalibr(document)) {
      take(calibration_import::read_kalibr(document));
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

/// The imported cameras with what our rig still lacks: names and places on the vehicle.
class RigBuilder {
 public:
  RigBuilder(std::vector<ImportedCamera> cameras, const RigImportOptions& options)
      : cameras_(std::move(cameras)), options_(options) {}

  ImportedRig build() {
    check_names();
    ImportedRig imported;
    for (int i = 0; i < kCameraCount; ++i) {
      imported.rig.cameras[i] = camera_named(i, imported.notes);
    }
    return imported;
  }

 private:
  std::string our_name(const ImportedCamera& camera) const {
    const auto mapped = options_.our_names.find(camera.name);
    return mapped == options_.our_names.end() ? camera.name : mapped->second;
  }

  void check_names() const {
    for (const auto& [theirs, ours] : options_.our_names) {
      const auto named = [&name = theirs](const auto& camera) { return camera.name == name; };
      if (std::ranges::none_of(cameras_, named)) {
        refuse("--map-camera", theirs, fmt::format("one of the files' cameras: {}", names()));
      }
      if (std::ranges::find(kCameraNames, ours) == kCameraNames.end()) {
        refuse("--map-camera", ours, fmt::format("one of {}", fmt::join(kCameraNames, ", ")));
      }
    }
  }

  std::string names() const {
    std::vector<std::string> found;
    for (const ImportedCamera& camera : cameras_) found.push_back(camera.name);
    return fmt::format("{}", fmt::join(found, ", "));
  }

  const ImportedCamera* find(std::string_view ours) const {
    const ImportedCamera* found = nullptr;
    for (const ImportedCamera& camera : cameras_) {
      if (our_name(camera) != ours) continue;
      if (found) {
        refuse(camera.place, fmt::format("a second camera {} (first at {})", ours, found->place),
               "one of each name");
      }
      found = &camera;
    }
    return found;
  }

  CameraModel camera_named(int index, std::vector<std::string>& notes) const {
    const std::string name(kCameraNames[index]);
    const ImportedCamera* found = find(name);
    if (!found) {
      if (!options_.base) {
        refuse(name, fmt::format("no such camera among {}", names()),
               "all six: name it with --map-camera THEIRS=OURS, or give --base RIG");
      }
      notes.push_back(fmt::format("{}: as in the base", name));
      return options_.base->cameras[index];
    }
    CameraModel camera;
    camera.intrinsics = found->intrinsics;
    if (camera.intrinsics.width_px == 0) {
      if (!options_.image_size_px) {
        refuse(found->place, "no size of the images", "--image-size WIDTHxHEIGHT");
      }
      camera.intrinsics.width_px = options_.image_size_px->first;
      camera.intrinsics.height_px = options_.image_size_px->second;
    }
    std::set<std::string> visited;
    std::optional<Se3> placed = vehicle_from(*found, visited);
    std::string source = "the files";
    if (const auto given = options_.vehicle_from.find(name); given != options_.vehicle_from.end()) {
      placed = given->second;
      source = "--extrinsics";
    } else if (!placed && options_.base) {
      placed = options_.base->cameras[index].vehicle_from_camera;
      source = "the base";
    }
    if (!placed) refuse(found->place, lacks(*found), wanted_for(*found, name));
    camera.vehicle_from_camera = *placed;
    notes.push_back(
        fmt::format("{}: {} ({}), extrinsics from {}", name, found->place, found->name, source));
    return camera;
  }

  static std::string lacks(const ImportedCamera& camera) {
    return camera.mounting ? fmt::format("a pose relative to {}", camera.mounting->parent)
                           : std::string("no pose on the vehicle");
  }

  static std::string wanted_for(const ImportedCamera& camera, const std::string& ours) {
    const std::string frame =
        camera.mounting && (camera.mounting->parent == "imu" || camera.mounting->parent == "world")
            ? camera.mounting->parent
            : ours;
    return fmt::format(
        "its place: --extrinsics FILE with `{}: {{translation_m: [x, y, z], rotation_wxyz: "
        "[w, x, y, z]}}` (vehicle_from_{}), or --base RIG",
        frame, frame == ours ? "camera" : frame);
  }

  /// Along the chain of parents, in either direction: a camera whose child has a known place has
  /// one, too.
  std::optional<Se3> vehicle_from(const ImportedCamera& camera,
                                  std::set<std::string>& visited) const {
    if (!visited.insert(camera.name).second) return std::nullopt;
    if (const auto given = options_.vehicle_from.find(our_name(camera));
        given != options_.vehicle_from.end()) {
      return given->second;
    }
    if (camera.mounting) {
      const auto& [parent, parent_from_camera] = *camera.mounting;
      if (parent == "vehicle") return parent_from_camera;
      if (const auto given = options_.vehicle_from.find(parent);
          given != options_.vehicle_from.end()) {
        return given->second * parent_from_camera;
      }
      for (const ImportedCamera& other : cameras_) {
        if (other.name != parent) continue;
        if (const auto placed = vehicle_from(other, visited)) return *placed * parent_from_camera;
      }
    }
    for (const ImportedCamera& child : cameras_) {
      if (!child.mounting || child.mounting->parent != camera.name) continue;
      if (const auto placed = vehicle_from(child, visited)) {
        return *placed * child.mounting->parent_from_camera.inverse();
      }
    }
    return std::nullopt;
  }

  std::vector<ImportedCamera> cameras_;
  const RigImportOptions& options_;
};

}  // namespace

Result<ImportedRig> import_rig(const std::vector<ForeignFile>& files,
                               const RigImportOptions& options) {
  try {
    Collector collector(options);
    for (const ForeignFile& file : files) collector.add(file);
    ImportedRig imported = RigBuilder(collector.finish(), options).build();
    // What a rig file would refuse is refused here.
    auto rig = parse_rig(format_rig(imported.rig), "imported rig");
    if (!rig) return tl::unexpected(rig.error());
    imported.rig = std::move(*rig);
    return imported;
  } catch (const ImportError& error) {
    return tl::unexpected(Error{error.message});
  } catch (const YAML::Exception& error) {
    return fail("line {}: found {}, wanted YAML or JSON", error.mark.line + 1, error.msg);
  }
}

Result<std::map<std::string, Se3>> parse_extrinsics(const std::string& text,
                                                    const std::string& name) {
  try {
    std::map<std::string, Se3> result;
    for (const auto& [frame, entry] : ForeignNode::parse(text, name).entries()) {
      const bool known = frame == "imu" || frame == "world" ||
                         std::ranges::find(kCameraNames, frame) != kCameraNames.end();
      if (!known) entry.reject(frame, "imu, world or one of our cameras");
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
