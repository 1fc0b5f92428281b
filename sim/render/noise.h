// Tables of reproducible noise: grain of materials, and pixel noise of the sensor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/render/ground_tile.h"

namespace bevloc::sim {

/// A square field that repeats seamlessly, with zero mean and a standard deviation of about 1. Rows
/// are stored beyond the period, so that a row of a tile is always contiguous. Immutable, and so
/// thread-safe.
class NoiseField {
 public:
  static constexpr int kRowLength = 2 * kTileNodes + 2;

  /// `values` are period x period numbers, row by row. `period` is a power of two.
  NoiseField(int period, std::vector<float> values);

  /// At least kRowLength contiguous values from node (ix, iy) on; any integers are allowed.
  const float* row(int64_t ix, int64_t iy) const;
  int period() const { return period_; }
  int pitch() const { return pitch_; }
  float at(int64_t ix, int64_t iy) const { return *row(ix, iy); }

 private:
  int period_;
  int pitch_;
  std::vector<float> values_;
};

/// Noise in the plane of the map. grain() repeats every 25.6 m and exists for every tile level.
/// patches() varies over metres and repeats every 409.6 m.
class GroundNoise {
 public:
  /// The noise is made at the first call. Thread-safe.
  static const GroundNoise& shared();

  const NoiseField& grain(int level) const { return grain_[static_cast<size_t>(level)]; }
  /// Distance between the nodes of patches().
  static constexpr double kPatchSpacingM = 0.8;
  const NoiseField& patches() const { return patches_; }

 private:
  GroundNoise();
  std::vector<NoiseField> grain_;
  NoiseField patches_;
};

/// A table of standard normal numbers, read from pseudo-random offsets. Immutable, and so
/// thread-safe.
class GaussianTable {
 public:
  static constexpr int kSize = 1 << 16;
  static const GaussianTable& shared();
  /// At least 4096 contiguous values, starting at an offset given by `hash`.
  const float* from(uint64_t hash) const { return &values_[hash % kSize]; }

 private:
  GaussianTable();
  std::vector<float> values_;
};

}  // namespace bevloc::sim
