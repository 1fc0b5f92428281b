#include <utility>

#include "evaluation/campaign/modes/mode_list.h"

namespace bevloc::evaluation {

const std::vector<Mode>& all_modes() {
  static const std::vector<Mode> kModes = [] {
    std::vector<Mode> modes;
    modes.push_back({.name = "none",
                     .what = "no fault",
                     .length = {},
                     .faults = {},
                     .match_faults = {},
                     .pace = {},
                     .limit_s = 0.0});
    for (auto* make : {gnss_modes, odometry_modes, match_modes, modes_without_gnss,
                       modes_without_match, lane_modes, sleep_modes, camera_modes, map_modes,
                       line_modes, bus_modes, clock_modes, manoeuvre_modes}) {
      for (Mode& mode : make()) modes.push_back(std::move(mode));
    }
    return modes;
  }();
  return kModes;
}

}  // namespace bevloc::evaluation
