// The answers that `bevloc init` needs, and the configuration that it writes from them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "common/cameras.h"
#include "common/result.h"

namespace bevloc::command {

/// The words of cameras.driver that init can set up.
inline constexpr const char* kMockCameras = "mock";
inline constexpr const char* kV4l2Cameras = "v4l2";
inline constexpr const char* kLibcameraCameras = "libcamera";

struct Answers {
  std::string driver;                         ///< driver of the cameras
  std::array<std::string, kCameraCount> ids;  ///< in the order of kCameraNames; unused with mock
  std::filesystem::path rig;
  std::filesystem::path map;  ///< empty for a procedural town, with mock cameras only
  std::filesystem::path model;
  std::string can;  ///< name of the interface, or "mock"
};

/// Returns a commented configuration that lies in `folder`. Files below this folder are written
/// relative to it, all others with their whole path.
std::string configuration_text(const Answers& answers, const std::filesystem::path& folder);

}  // namespace bevloc::command
