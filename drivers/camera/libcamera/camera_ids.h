// Lists the ids of libcamera's cameras.
#pragma once

#include <string>
#include <vector>

#include <fmt/ranges.h>
#include <libcamera/libcamera.h>

namespace bevloc::drivers::libcam {

inline std::vector<std::string> ids_of(const libcamera::CameraManager& manager) {
  std::vector<std::string> ids;
  for (const auto& camera : manager.cameras()) ids.push_back(camera->id());
  return ids;
}

/// Returns the error message for an id that is not in `ids`.
inline std::string no_camera_called(const std::string& id, const std::vector<std::string>& ids) {
  return fmt::format("no camera is called \"{}\"; available: {}", id,
                     ids.empty() ? "none" : fmt::format("\"{}\"", fmt::join(ids, "\", \"")));
}

}  // namespace bevloc::drivers::libcam
