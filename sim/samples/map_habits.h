// Redraws a map as surveys usually draw it, where that differs from what a camera sees.
#pragma once

#include <cstdint>

#include "pipeline/map/hd_map.h"

namespace bevloc::sim {

/// Shares of lines that have a habit of published maps. All are independent; 0 changes nothing.
struct MapHabits {
  double short_divider = 0.0;    ///< divider ends that lie 5 to 30 m before the end of the paint
  double long_divider = 0.0;     ///< divider ends that lie 5 to 20 m beyond it, in the junction
  double broken_divider = 0.0;   ///< dividers that lack 10 to 40 m, as at a side road
  double inner_boundary = 0.0;   ///< boundaries up to 0.7 m inside, like an outline of lanes
  double closed_mouth = 0.0;     ///< boundary ends that go on 5 to 20 m straight, across a mouth
  double double_boundary = 0.0;  ///< boundaries with another one 0.5 to 4 m outside, like a wall

  bool operator==(const MapHabits&) const = default;
};

/// Multiplies all shares by a factor; none exceeds 1.
MapHabits scaled(const MapHabits& habits, double factor);

/// Lanes do not change. Elements that are too short for a habit keep their form.
HdMap with_habits(const HdMap& map, const MapHabits& habits, uint64_t seed);

}  // namespace bevloc::sim
