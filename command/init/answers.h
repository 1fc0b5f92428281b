// What `bevloc init` has to know, and the configuration that it writes from that.
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
  std::string driver;                         ///< of the cameras
  std::array<std::string, kCameraCount> ids;  ///< in the order of kCameraNames; unused with mock
  std::filesystem::path rig;
  std::filesystem::path map;  ///< empty: a procedural town; with mock cameras only
  std::filesystem::path model;
  std::string can;  ///< name of the interface, or "mock"
};

/// A commented configuration that stands in `folder`: files below it are written relative to it,
/// all others with their whole path.
std::string configuration_text(const Answers& answers, const std::filesystem::path& folder);

}  // namespace bevloc::command
