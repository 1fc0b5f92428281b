// What the lists of modes are written with.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "evaluation/campaign/modes/mode.h"

namespace bevloc::evaluation {

constexpr FaultLength kTwenty{20.0};
constexpr FaultLength kToTheEnd{};
constexpr FaultLength kAlways{.seconds = 0.0, .from_start = true};

/// A fault of the vehicle, the bus, the map or all cameras.
sim::Fault fault(sim::FaultKind kind, const sim::FaultAmounts& amounts = {});
/// A fault of one camera, or of two cameras that change places.
sim::Fault fault(sim::FaultKind kind, const sim::FaultAmounts& amounts, int camera,
                 std::optional<int> other = std::nullopt);

/// A match that lies this far to the left of the true place.
MatchFault locked(double across_m);

/// A list of modes that have something in common.
class ModeList {
 public:
  /// `common`: what all modes of the list have in common.
  explicit ModeList(Mode common = {});

  void add(std::string_view name, std::string_view what, FaultLength length,
           std::vector<sim::Fault> faults, std::vector<MatchFault> match_faults, WhyMask named_by);
  void add(std::string_view name, std::string_view what, FaultLength length,
           const sim::Fault& what_fails, WhyMask named_by);
  void add(std::string_view name, std::string_view what, FaultLength length,
           const MatchFault& what_fails, WhyMask named_by);
  /// A mode in which the vehicle does not keep to its planned speed.
  void add(std::string_view name, std::string_view what, FaultLength length,
           std::vector<sim::PacePoint> pace, std::vector<sim::Fault> faults);

  std::vector<Mode> all() &&;

 private:
  Mode common_;
  std::vector<Mode> modes_;
};

// The lists, by the input that fails.

std::vector<Mode> gnss_modes();
std::vector<Mode> odometry_modes();
/// Faults of the matcher, which only the stage level can set at will.
std::vector<Mode> match_modes();
/// A second fault while GNSS is missing.
std::vector<Mode> modes_without_gnss();
/// A second fault while the match says nothing.
std::vector<Mode> modes_without_match();
/// The match cannot tell a lane from its neighbours.
std::vector<Mode> lane_modes();
/// The appliance sleeps, and wakes up with or without a second fault.
std::vector<Mode> sleep_modes();
/// Faults of the cameras, which only pictures can show.
std::vector<Mode> camera_modes();
/// Differences between the map and the world, which only pictures can show. They exist from the
/// start, except for the hole in the map.
std::vector<Mode> map_modes();
/// Visible lines that are not where the map has them, so that the match itself is wrong.
std::vector<Mode> line_modes();
/// Faults of the bus between the vehicle and the appliance.
std::vector<Mode> bus_modes();
/// The vehicle crawls, stands or reverses. In some modes GNSS fails, too.
std::vector<Mode> manoeuvre_modes();
/// Faults of the clocks of the whole appliance. No why bit names a step of the system clock,
/// because it must have no effect.
std::vector<Mode> clock_modes();

}  // namespace bevloc::evaluation
