// The frames of the bus as a candump log.
#pragma once

#include <filesystem>
#include <fstream>

#include "can/bus/bus.h"
#include "common/result.h"
#include "common/time.h"

namespace bevloc::evaluation {

/// A file with one line for each frame, as `candump -L` writes it. One thread.
class BusLog {
 public:
  /// Fails if the file cannot be created.
  static Result<BusLog> create(const std::filesystem::path& path);

  /// `time` counts from the start of the log.
  void add(Duration time, const can::Frame& frame);

  /// Fails if a frame is not in the file, such as on a full disk. Call it after the last add().
  Status finish();

 private:
  explicit BusLog(const std::filesystem::path& path) : path_(path), file_(path) {}

  std::filesystem::path path_;
  std::ofstream file_;
};

}  // namespace bevloc::evaluation
