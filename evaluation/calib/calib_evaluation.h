// `bevloc eval calib`: how well `bevloc calib refine` recovers known errors of a calibration.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "evaluation/calib/simulated_recording.h"

namespace bevloc::evaluation {

class CalibEvaluation {
 public:
  void declare(CLI::App& eval);
  Status run() const;

 private:
  SimulatedRecordingOptions options_;
  int drives_ = 1;
  std::string json_file_;
};

}  // namespace bevloc::evaluation
