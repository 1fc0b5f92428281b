// Reads the images of the drive, which drive_pictures rendered beforehand.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.h"
#include "tests/hil/usb_cameras/uvc_descriptors.h"

namespace bevloc::hil {

/// The images of one camera: FOLDER/<camera>/<number>.yuyv, numbered from 0 without gaps.
/// Immutable.
class Pictures {
 public:
  /// Fails if the folder has no image of `camera`.
  static Result<Pictures> open(const std::filesystem::path& folder, const std::string& camera);

  /// Returns image `index`, encoded in `format`. Beyond the last image it returns the last one.
  Result<Bytes> read(uint64_t index, PixelFormat format) const;

 private:
  Pictures(std::filesystem::path folder, uint64_t count)
      : folder_(std::move(folder)), count_(count) {}

  std::filesystem::path folder_;
  uint64_t count_;
};

}  // namespace bevloc::hil
