// The pictures of one frameset in files, and how the vehicle moved between them.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "common/image.h"
#include "common/result.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/localization/localizer.h"

namespace bevloc::evaluation {

/// Six pictures that were taken at about the same time.
struct PictureSet {
  std::array<RgbImage, kCameraCount> pictures;
  CameraMask present;
  CameraMotions reference_from_exposure{};
  std::vector<std::filesystem::path> files;   ///< that were read
  std::vector<std::filesystem::path> strays;  ///< pictures of the folder that are of no camera

  /// The borrowed pictures. The set must outlive the result.
  CameraImages images() const;
};

/// Reads the pictures of a folder: for each camera a file CAMERA.png, CAMERA.jpg or CAMERA.jpeg,
/// such as front_left.jpg, of the size that the rig states. The case of the extension does not
/// matter. A camera without a file is missing. Fails if the folder cannot be read, if all cameras
/// are missing, if a camera has several files, if one cannot be read, or if a viewer would turn one
/// (read_camera_picture()).
Result<PictureSet> read_pictures(const std::filesystem::path& folder, const Rig& rig);

/// Reads a file of motions: for each camera the vehicle's pose at its exposure, in the vehicle
/// frame at the reference time. Cameras that the file does not name expose at the reference time.
///
///     front: {x_m: -0.33, y_m: 0.003, yaw_deg: -0.004}
Result<CameraMotions> read_motions(const std::filesystem::path& file);

}  // namespace bevloc::evaluation
