// An open V4L2 device.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "common/result.h"

namespace bevloc::drivers::v4l2 {

/// Closed when the last owner lets go of it. Thread safe, as the kernel is.
class Device {
 public:
  /// Fails for what is no device that captures single-plane video by streaming.
  static Result<std::shared_ptr<Device>> open(const std::filesystem::path& node);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  int fd() const { return fd_; }
  /// Card and node, for messages.
  const std::string& name() const { return name_; }

  /// 0 or errno; interrupted calls are made again.
  int call(unsigned long request, void* argument) const;

 private:
  explicit Device(int fd) : fd_(fd) {}

  const int fd_;
  std::string name_;
};

}  // namespace bevloc::drivers::v4l2
