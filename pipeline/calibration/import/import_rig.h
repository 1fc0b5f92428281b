// Makes a rig from the calibration files of other programs.
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
  std::string name;  ///< the path, whose stem and ending matter, too
  std::string text;
};

struct RigImportOptions {
  /// Maps the files' names of cameras to ours. A camera without an entry must already have one of
  /// our names, or it is left out.
  std::map<std::string, std::string> our_names;
  /// The transforms vehicle_from_X by the name of X: one of our cameras, or a parent ("imu",
  /// "world"). A frame that no imported camera needs is refused.
  std::map<std::string, Se3> vehicle_from;
  /// This rig provides what the files lack: whole cameras, extrinsics, and the outline of the own
  /// vehicle.
  std::optional<Rig> base;
  /// Width and height for formats without them, in pixels.
  std::optional<std::pair<int, int>> image_size_px;
  std::vector<std::string> tokens;  ///< tokens of nuScenes' calibrated sensors
};

struct ImportedRig {
  Rig rig;
  /// One sentence per camera of the rig, which says where its values came from. Then one per camera
  /// of the files that is left out, which says why.
  std::vector<std::string> notes;
};

/// Recognises each file by its content: Kalibr camchain, OpenCV FileStorage, ROS camera_info,
/// nuScenes calibrated_sensor and sensor, COLMAP cameras.txt and images.txt. readers.h has their
/// conventions. Fails, with file, line and key, if a file is broken or says what bevloc's camera
/// model cannot express, if a camera is missing, if no camera has one of our names, and if the rig
/// cannot be that of a vehicle (rig_check.h).
Result<ImportedRig> import_rig(const std::vector<ForeignFile>& files,
                               const RigImportOptions& options);

/// Reads pairs THEIRS=OURS, one for each camera, for RigImportOptions::our_names.
Result<std::map<std::string, std::string>> parse_camera_names(
    const std::vector<std::string>& pairs);

/// Reads RigImportOptions::vehicle_from. For each name, the text has a map with translation_m and
/// rotation_wxyz, as in a rig file.
Result<std::map<std::string, Se3>> parse_extrinsics(const std::string& text,
                                                    const std::string& name);

}  // namespace bevloc
