// Tables of repeatable noise: material grain on the ground, and the sensor's pixel noise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/render/ground_tile.h"

namespace bevloc::sim {

/// A square, seamlessly repeating field of zero mean and about unit standard deviation. Rows are
/// stored longer than the period, so that a tile's row is always contiguous.
class NoiseField {
 public:
  static constexpr int kRowLength = 2 * kTileNodes + 2;

  NoiseField(int period, std::vector<float> values);

  /// kRowLength values starting at node (ix, iy), which may be any integers.
  const float* row(int64_t ix, int64_t iy) const;
  int period() const { return period_; }
  int pitch() const { return pitch_; }
  float at(int64_t ix, int64_t iy) const { return *row(ix, iy); }

 private:
  int period_;
  int pitch_;
  std::vector<float> values_;
};

/// Noise in the plane of the map. `grain` repeats every 25.6 m and is kept at every tile level;
/// `patches` varies over metres and repeats every 409.6 m.
class GroundNoise {
 public:
  /// Made once in the life of the process; safe from any thread.
  static const GroundNoise& shared();

  const NoiseField& grain(int level) const { return grain_[static_cast<size_t>(level)]; }
  /// Spacing of the nodes of patches().
  static constexpr double kPatchSpacingM = 0.8;
  const NoiseField& patches() const { return patches_; }

 private:
  GroundNoise();
  std::vector<NoiseField> grain_;
  NoiseField patches_;
};

/// Standard normal numbers to be read from random offsets.
class GaussianTable {
 public:
  static constexpr int kSize = 1 << 16;
  static const GaussianTable& shared();
  /// At least `count` <= 4096 values.
  const float* from(uint64_t hash) const { return &values_[hash % kSize]; }

 private:
  GaussianTable();
  std::vector<float> values_;
};

}  // namespace bevloc::sim
