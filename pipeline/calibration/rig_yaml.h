// Reads and writes rig files, the calibration of a vehicle.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.h"
#include "pipeline/calibration/rig.h"

namespace bevloc {

/// Reads a rig file. It contains one entry for each of the six cameras (kCameraNames):
///
///     cameras:
///       front_left:
///         image_size_px: [640, 360]
///         fx_px: 509.04
///         fy_px: 509.04
///         cx_px: 330.34
///         cy_px: 191.62
///         lens: pinhole                          # the default, or fisheye
///         distortion: [-0.06, 0.01, 0, 0]        # k1, k2, p1, p2 as OpenCV names them; of a
///                                                # fisheye k1, k2, k3, k4
///         own_body_px: [0, 359, 320, 300, 639, 359]  # optional: corners of the part that
///                                                # shows the own vehicle, column and row in turn
///         vehicle_from_camera:
///           translation_m: [1.524, 0.495, 1.509] # position of the camera
///           rotation_wxyz: [0.66, -0.66, 0.25, -0.26]
///       front: ...
///
/// The rotation is a unit quaternion that rotates camera axes (x right, y down, z forward) into
/// vehicle axes (x forward, y left, z up). A norm within 0.001 of 1 is accepted and normalised. The
/// origin of the vehicle frame is on the ground below the middle of the rear axle. Pixel (0, 0) is
/// the centre of the top left pixel.
///
/// Fails with file, line and key on a missing, unknown or repeated key, on a bad value, and on a
/// rig that cannot be that of a vehicle (rig_check.h).
Result<Rig> read_rig(const std::filesystem::path& path);

/// Does the same for a text in memory. Error messages show `name` as the file.
Result<Rig> parse_rig(const std::string& text, const std::string& name);

/// The text of a rig file, with nine decimals per number.
std::string format_rig(const Rig& rig);

}  // namespace bevloc
