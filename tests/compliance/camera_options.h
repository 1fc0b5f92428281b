// Which cameras of this machine the conformance suite is run on.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tests/drivers/camera_under_test.h"

namespace bevloc::drivers {

class CameraOptions {
 public:
  explicit CameraOptions(CLI::App& app);

  /// Tells the suite, once the command line has been read.
  void apply();

 private:
  CameraDevices devices_;
  std::vector<std::string> formats_ = {"yuyv", "uyvy", "nv12", "mjpeg"};
  double exposure_ms_ = 0.0;
  double readout_ms_ = 0.0;
  std::vector<std::string> controls_;
};

}  // namespace bevloc::drivers
