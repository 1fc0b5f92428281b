// Computes kLanes Fourier transforms at once.
#pragma once

#include <vector>

#include "pipeline/solver/lanes.h"

namespace bevloc {

/// kLanes complex signals of the same length: sample n of lane k is at [n * kLanes + k].
struct FftTile {
  explicit FftTile(int length)
      : re(static_cast<size_t>(length) * kLanes), im(static_cast<size_t>(length) * kLanes) {}

  LaneBuffer re;
  LaneBuffer im;
};

/// X[k] = sum over n of x[n] exp(-2 pi i k n / length), by Stockham's algorithm, which needs no bit
/// reversal. It uses radix 4 while 4 divides the length, then 2 and 5. The constructor allocates
/// all memory. One thread.
class LanesFft {
 public:
  /// Whether the length has the form 2^a 5^b.
  static bool supports(int length);
  /// The smallest power of two that is not below `least`.
  static int power_of_two_from(int least);

  /// `length` must be supported.
  explicit LanesFft(int length);

  int length() const { return length_; }

  /// Transforms a tile in place. The tile must have this length.
  void transform(FftTile& tile);

  /// Does the same for a tile whose second half is zero, and does not read that half. Call it only
  /// if can_halve().
  void transform_half(FftTile& tile);
  bool can_halve() const { return length_ % 4 == 0; }

  /// Does the same as transform(), but writes sample k of all lanes to re and im + k *
  /// sample_stride. `tile` is overwritten. The length must be above 1.
  void transform_to(FftTile& tile, float* re, float* im, std::ptrdiff_t sample_stride);

 private:
  /// One pass over the data: `groups` times `stride` interleaved transforms of `radix` points.
  struct Stage {
    int radix = 0;
    int groups = 0;
    int stride = 0;
    /// [group, output 1 ... radix - 1, real and imaginary part]
    std::vector<float> twiddles;
  };

  int length_;
  std::vector<Stage> stages_;
  FftTile scratch_;
};

}  // namespace bevloc
