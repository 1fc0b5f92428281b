// Sixteen Fourier transforms at once.
#pragma once

#include <vector>

#include "pipeline/solver/lanes.h"

namespace bevloc {

/// Sixteen complex signals of one length side by side: sample n of lane k at [n * kLanes + k].
struct FftTile {
  explicit FftTile(int length)
      : re(static_cast<size_t>(length) * kLanes), im(static_cast<size_t>(length) * kLanes) {}

  LaneBuffer re;
  LaneBuffer im;
};

/// X[k] = sum over n of x[n] exp(-2 pi i k n / length), in Stockham's order, which needs no bit
/// reversal: radix 4 as far as it goes, then 2 and 5. Memory is made in the constructor. Not thread
/// safe.
class LanesFft {
 public:
  /// Lengths of the form 2^a 5^b.
  static bool supports(int length);
  /// The smallest length that is supported, a power of two, and not below `least`.
  static int power_of_two_from(int least);

  /// `length` must be supported.
  explicit LanesFft(int length);

  int length() const { return length_; }

  /// In place. The tile must have this length.
  void transform(FftTile& tile);

  /// The same where the second half of the samples is zero: it is not read. For lengths that
  /// can_halve().
  void transform_half(FftTile& tile);
  bool can_halve() const { return length_ % 4 == 0; }

  /// The same into other memory, sample k of all lanes at k * sample_stride; `tile` is used up. For
  /// lengths above 1.
  void transform_to(FftTile& tile, float* re, float* im, std::ptrdiff_t sample_stride);

 private:
  /// One pass over the data: `stride` interleaved transforms of `radix` points, `groups` times.
  struct Stage {
    int radix = 0;
    int groups = 0;
    int stride = 0;
    /// For each group the factors of outputs 1 ... radix - 1, real and imaginary.
    std::vector<float> twiddles;
  };

  int length_;
  std::vector<Stage> stages_;
  FftTile scratch_;
};

}  // namespace bevloc
