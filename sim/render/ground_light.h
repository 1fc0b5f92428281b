// Shadows and pools of lamplight on the ground around the vehicle.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sim/render/coverage_mask.h"
#include "sim/render/lighting.h"
#include "sim/render/surroundings.h"

namespace bevloc::sim {

/// A square of cells around the vehicle. Each holds, from the low byte up: how much of the sun it
/// sees, how much of the sky, and how much lamplight it gets.
class GroundLight {
 public:
  static constexpr int kSide = 256;
  static constexpr double kCellM = 0.35;

  GroundLight();

  void build(const Eigen::Vector2d& centre, const Surroundings& surroundings,
             const Lighting& lighting);

  const uint32_t* cells() const { return cells_.data(); }
  /// Map position of the middle of cell (0, 0); cell (i, j) is i cells east and j north of it.
  const Eigen::Vector2d& origin() const { return origin_; }

 private:
  Eigen::Vector2f cell(const Eigen::Vector2d& map) const {
    return ((map - origin_) / kCellM).cast<float>();
  }
  void cast_shadows(const Surroundings& surroundings, const Lighting& lighting);
  void cast_body_shadow(const VehicleBody& body, const Eigen::Vector2d& shift_per_m);
  void add_quad(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& from,
                const Eigen::Vector2d& to);
  void add_footprint(const VehicleBody& body, double margin_m);
  /// The dark strip where a wall meets the ground.
  void add_foot(const WallPiece& piece);
  void light_lamps(const Surroundings& surroundings, const Lighting& lighting);
  /// Reads the mask into a plane of 1 - strength * coverage and softens it.
  void take_mask(float strength, std::vector<float>& plane);
  void pack();

  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  CoverageMask mask_{kSide, kSide};
  std::vector<float> sun_, sky_, lamps_, scratch_;
  std::vector<uint32_t> cells_;
};

}  // namespace bevloc::sim
