// How the cost grows with the size of each thing that can be had in several sizes.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"
#include "firmware/config.h"

namespace bevloc::bench {

struct SweepResult {
  std::string name;
  std::string about;  ///< what is measured, and what is not
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
};

struct SweepOptions {
  int frames = 50;  ///< timed for each row
  int threads = 1;
  double longest_map_km = 10'000.0;
};

inline constexpr std::array<std::string_view, 5> kSweepNames{"cameras", "image", "bev",
                                                             "hypotheses", "map"};

/// One of kSweepNames. Fails where configuration, model, map or rig do.
Result<SweepResult> run_sweep(std::string_view name, const firmware::Config& config,
                              const SweepOptions& options);

}  // namespace bevloc::bench
