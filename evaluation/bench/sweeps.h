// Measures how run time scales with each configurable size.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"
#include "evaluation/drive/drive_config.h"

namespace bevloc::bench {

struct SweepResult {
  std::string name;
  std::string about;  ///< one sentence for the table: what is measured
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
};

struct SweepOptions {
  int frames = 50;  ///< runs timed per row
  int threads = 1;
};

inline constexpr std::array<std::string_view, 5> kSweepNames{"cameras", "image", "bev",
                                                             "hypotheses", "map"};

/// `name` must be one of kSweepNames. Fails if model, map or rig cannot be used.
Result<SweepResult> run_sweep(std::string_view name, const evaluation::DriveConfig& config,
                              const SweepOptions& options);

}  // namespace bevloc::bench
