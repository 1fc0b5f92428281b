// Makes a rig of the calibration files of other programs.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/result.h"
#include "pipeline/calibration/rig.h"

namespace bevloc {

struct ForeignFile {
  std::string name;  ///< its path; its ending and stem matter, too
  std::string text;
};

struct RigImportOptions {
  /// Our names of cameras by theirs. A camera without an entry must already have one of our names,
  /// or it is left out.
  std::map<std::string, std::string> our_names;
  /// vehicle_from_X of frames by name: our cameras, and the parents "imu" and "world". A frame that
  /// no imported camera needs is refused.
  std::map<std::string, Se3> vehicle_from;
  /// What the files lack comes from this rig: whole cameras, and extrinsics.
  std::optional<Rig> base;
  /// Width and height for formats without them, in pixels.
  std::optional<std::pair<int, int>> image_size_px;
  std::vector<std::string> tokens;  ///< of nuScenes' calibrated sensors
};

struct ImportedRig {
  Rig rig;
  /// One sentence per camera: what came from where.
  std::vector<std::string> notes;
};

/// Recognises each file by its content: Kalibr camchain, OpenCV FileStorage, ROS camera_info,
/// nuScenes calibrated_sensor and sensor, COLMAP cameras.txt and images.txt. readers.h has their
/// conventions. Fails with file, line and key on what is broken, on what bevloc's camera model
/// cannot express, on a camera that is missing, if no camera has one of our names, and on a rig
/// that cannot be that of a vehicle (rig_check.h).
Result<ImportedRig> import_rig(const std::vector<ForeignFile>& files,
                               const RigImportOptions& options);

/// Reads THEIRS=OURS, once for each camera, for RigImportOptions.
Result<std::map<std::string, std::string>> parse_camera_names(
    const std::vector<std::string>& pairs);

/// Reads vehicle_from_X for RigImportOptions: for each name a map with translation_m and
/// rotation_wxyz, as in a rig file.
Result<std::map<std::string, Se3>> parse_extrinsics(const std::string& text,
                                                    const std::string& name);

}  // namespace bevloc
