// Computes shadows and lamp light on the ground around the vehicle.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sim/render/coverage_mask.h"
#include "sim/render/lighting.h"
#include "sim/render/surroundings.h"

namespace bevloc::sim {

/// A square grid of cells around the vehicle. The bytes of a cell, from the lowest: visible share
/// of the sun, visible share of the sky, lamp light. One thread.
class GroundLight {
 public:
  static constexpr int kSide = 256;
  static constexpr double kCellM = 0.35;

  GroundLight();

  /// Computes all cells for a square around `centre` (map frame).
  void build(const Eigen::Vector2d& centre, const Surroundings& surroundings,
             const Lighting& lighting);

  const uint32_t* cells() const { return cells_.data(); }
  /// Map position of the centre of cell (0, 0). Cell (i, j) is i cells east and j cells north of
  /// it.
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
  /// Adds the dark strip where a wall meets the ground.
  void add_foot(const WallPiece& piece);
  void light_lamps(const Surroundings& surroundings, const Lighting& lighting);
  /// Writes 1 - strength * coverage from the mask into a plane and blurs it.
  void take_mask(float strength, std::vector<float>& plane);
  /// Packs the planes into cells_.
  void pack();

  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  CoverageMask mask_{kSide, kSide};
  std::vector<float> sun_, sky_, lamps_, scratch_;
  std::vector<uint32_t> cells_;
};

}  // namespace bevloc::sim
