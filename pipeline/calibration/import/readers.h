// Reads the calibration files of other programs. All functions throw ImportError (foreign_node.h).
// name_after_files() (camera_names.h) may change the names that they give.
#pragma once

#include <string>
#include <vector>

#include "pipeline/calibration/import/foreign_node.h"
#include "pipeline/calibration/import/imported_camera.h"

namespace bevloc::calibration_import {

/// Reads Kalibr's camchain: `cam0`, `cam1` and so on. A camera gets its name from the first word of
/// its `rostopic`, or from its key if it has no topic or if another camera has that name. The
/// camera_model must be pinhole, and the distortion_model radtan, equidistant or none. T_cam_imu
/// maps points of the IMU into the camera; T_imu_cam of OpenVINS maps points of the camera into the
/// IMU. T_cn_cnm1 maps points of the camera before (cam2 for cam3) into this one. timeshift_cam_imu
/// is not used.
std::vector<ImportedCamera> read_kalibr(const ForeignNode& document);

/// Reads a FileStorage file of OpenCV: camera_matrix (or K), distortion_coefficients (or
/// distortion, dist_coeffs, D), and image_width and image_height if it has them. The lens is a
/// fisheye if fisheye_model is 1. The camera has the name `stem`, that of the file, unless the file
/// has camera_name.
ImportedCamera read_opencv(const ForeignNode& document, const std::string& stem);

/// Reads a camera_info file of ROS with distortion_model plumb_bob, rational_polynomial or
/// equidistant, and without binning and region of interest.
ImportedCamera read_camera_info(const ForeignNode& document, const std::string& stem);

/// Reads calibrated_sensor.json and sensor.json of nuScenes. A camera has the name of its channel
/// (CAM_FRONT). Its rotation (w, x, y, z) and translation map camera points into the ego vehicle.
/// If a channel has several different calibrations, `tokens` must choose one. If there are tokens,
/// only the cameras that they name are read.
std::vector<ImportedCamera> read_nuscenes(const ForeignNode& calibrated_sensors,
                                          const ForeignNode& sensors,
                                          const std::vector<std::string>& tokens);

/// Reads cameras.txt of COLMAP, and images.txt if it has a name. COLMAP's principal point counts
/// from the corner of the image, bevloc's from the centre of the first pixel. An image gives its
/// camera a name: its first folder, or its stem if it has none; its pose (w, x, y, z and
/// translation) maps points of COLMAP's world into the camera. Without images.txt the id is the
/// name.
std::vector<ImportedCamera> read_colmap(const std::string& cameras, const std::string& cameras_name,
                                        const std::string& images, const std::string& images_name);

}  // namespace bevloc::calibration_import
