// The drive's pictures, drawn ahead of time by drive_pictures.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.h"
#include "tests/hil/usb_cameras/uvc_descriptors.h"

namespace bevloc::hil {

/// FOLDER/<camera>/<number>.yuyv, numbered from 0 without gaps. Stateless.
class Pictures {
 public:
  /// Fails when `camera` has none in the folder.
  static Result<Pictures> open(const std::filesystem::path& folder, const std::string& camera);

  /// Picture `index` as it goes over the cable; after the last, the last again.
  Result<Bytes> read(uint64_t index, PixelFormat format) const;

 private:
  Pictures(std::filesystem::path folder, uint64_t count)
      : folder_(std::move(folder)), count_(count) {}

  std::filesystem::path folder_;
  uint64_t count_;
};

}  // namespace bevloc::hil
