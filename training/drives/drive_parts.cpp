#include "training/drives/drive_parts.h"

#include <cmath>

#include "sim/random.h"

namespace bevloc::drives {
namespace {

// Each square has one of kNumbers pseudo-random numbers. Networks have been trained with these
// values, so they must stay as they are.
constexpr uint64_t kNumbers = 8;
constexpr uint64_t kHeldBackNumber = 2;
constexpr uint64_t kCalibrationNumber = 3;

double distance_to(const Square& square, const Eigen::Vector2d& place) {
  const Eigen::Vector2d low(kSquare_m * static_cast<double>(square.east),
                            kSquare_m * static_cast<double>(square.north));
  const Eigen::Vector2d high = low.array() + kSquare_m;
  return (place - place.cwiseMax(low).cwiseMin(high)).norm();
}

}  // namespace

Square square_at(const Eigen::Vector2d& place) {
  return {std::llround(std::floor(place.x() / kSquare_m)),
          std::llround(std::floor(place.y() / kSquare_m))};
}

DrivePart part_of(const Square& square) {
  const uint64_t row = sim::mix_seed(static_cast<uint64_t>(square.north));
  const uint64_t number = sim::mix_seed(row + static_cast<uint64_t>(square.east)) % kNumbers;
  if (number == kHeldBackNumber) return DrivePart::kHeldBack;
  return number == kCalibrationNumber ? DrivePart::kCalibration : DrivePart::kTraining;
}

std::optional<DrivePart> part_at(const Eigen::Vector2d& place) {
  static_assert(kSeen_m < kSquare_m, "a sample shows no square beyond the neighbours of its own");
  const Square own = square_at(place);
  const DrivePart part = part_of(own);
  for (int64_t east = own.east - 1; east <= own.east + 1; ++east) {
    for (int64_t north = own.north - 1; north <= own.north + 1; ++north) {
      const Square other{east, north};
      if (part_of(other) > part && distance_to(other, place) < kSeen_m) return std::nullopt;
    }
  }
  return part;
}

}  // namespace bevloc::drives
