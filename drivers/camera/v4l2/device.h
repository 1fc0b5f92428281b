// An open V4L2 device.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/file_descriptor.h"
#include "common/result.h"

namespace bevloc::drivers::v4l2 {

/// Returns the message for a device that open() refused with this errno.
std::string open_error(const std::filesystem::path& node, int error);

/// Whether the device can capture single-plane video by streaming. Opens it for a moment. Returns
/// nothing if it cannot be opened or does not answer.
std::optional<bool> can_capture(const std::filesystem::path& node);

/// The destructor closes the device. Thread-safe, because the calls of the kernel are.
class Device {
 public:
  /// Fails for a device that cannot capture single-plane video by streaming.
  static Result<std::shared_ptr<Device>> open(const std::filesystem::path& node);

  int fd() const { return fd_.get(); }
  /// Card and node, such as "HD Camera (/dev/video0)", for messages.
  const std::string& name() const { return name_; }

  /// Makes an ioctl() call and returns 0 or errno. Interrupted calls are repeated.
  int call(unsigned long request, void* argument) const;

 private:
  explicit Device(FileDescriptor fd) : fd_(std::move(fd)) {}

  const FileDescriptor fd_;
  std::string name_;
};

}  // namespace bevloc::drivers::v4l2
