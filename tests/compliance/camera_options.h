// Command line options that select the cameras for the conformance suite.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tests/drivers/camera_under_test.h"

namespace bevloc::drivers {

class CameraOptions {
 public:
  explicit CameraOptions(CLI::App& app);

  /// Passes the cameras to the suite. Call it after the command line was parsed.
  void apply();

 private:
  CameraDevices devices_;
  std::vector<std::string> formats_ = {"yuyv", "uyvy", "nv12", "mjpeg"};
  double exposure_ms_ = 0.0;
  double readout_ms_ = 0.0;
  std::vector<std::string> controls_;
};

}  // namespace bevloc::drivers
