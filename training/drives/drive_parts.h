// Which part of the training samples a place belongs to.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include <Eigen/Core>

namespace bevloc::drives {

/// Which places the samples are from. No sample shows a place of a part that comes later in this
/// list.
enum class DrivePart : uint8_t {
  kTraining,     ///< the network learns from them
  kCalibration,  ///< for the ranges of int8, the scales of the solvers and the early stop
  kHeldBack,     ///< for the figures of a report
};

/// All parts with their names on the command line.
inline constexpr std::array<std::pair<std::string_view, DrivePart>, 3> kDriveParts{
    {{"training", DrivePart::kTraining},
     {"calibration", DrivePart::kCalibration},
     {"held-back", DrivePart::kHeldBack}}};

/// The map is divided into squares of this width.
inline constexpr double kSquare_m = 100.0;
/// How far from its reference pose a sample shows the map, at any heading: 30 m along and 15 m
/// across (kRasterGrid) from a prior that is up to 2 m and 1 m off (sim::random_correction()).
inline constexpr double kSeen_m = 36.0;

/// A square of the map. Its south-west corner lies kSquare_m times these numbers east and north of
/// the origin of the map frame.
struct Square {
  int64_t east = 0;
  int64_t north = 0;
};

/// The square of a place in the map frame (m).
Square square_at(const Eigen::Vector2d& place);

/// The part of a square: an eighth of all squares is held back, another eighth is for calibration.
/// It depends on the square alone. So a place is in the same part in every set of drives, and a
/// network that trains on one set after another never learns from a place that is held back, as
/// long as the origin of the map frame stays.
DrivePart part_of(const Square& square);

/// The part of a sample at this place in the map frame (m). None if the sample would show a square
/// of a later part, whether or not a drive goes through that square.
std::optional<DrivePart> part_at(const Eigen::Vector2d& place);

}  // namespace bevloc::drives
