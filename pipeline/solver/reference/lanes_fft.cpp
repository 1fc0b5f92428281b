#include "pipeline/solver/reference/lanes_fft.h"

#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/target_clones.h"

namespace bevloc {
namespace {

/// Input, output and factors of one pass.
struct Pass {
  const float* in_re;
  const float* in_im;
  float* out_re;
  float* out_im;
  const float* twiddles;
  int groups;
  int stride;
  std::ptrdiff_t out_sample;  ///< floats from one output to the next
};

struct Complex {
  Lanes re;
  Lanes im;
};

/// Writes value * (w_re + i w_im).
inline void store_product(const Pass& pass, std::ptrdiff_t at, const Complex& value, float w_re,
                          float w_im) {
  lanes(pass.out_re + at) = w_re * value.re - w_im * value.im;
  lanes(pass.out_im + at) = w_re * value.im + w_im * value.re;
}

BEVLOC_TARGET_CLONES void radix2(const Pass& pass) {
  const std::ptrdiff_t in_step = static_cast<std::ptrdiff_t>(pass.groups) * pass.stride * kLanes;
  const std::ptrdiff_t out_step = pass.stride * pass.out_sample;
  for (int p = 0; p < pass.groups; ++p) {
    const float* w = pass.twiddles + 2 * p;
    for (int q = 0; q < pass.stride; ++q) {
      const std::ptrdiff_t in = static_cast<std::ptrdiff_t>(p * pass.stride + q) * kLanes;
      const std::ptrdiff_t out = (2 * p * pass.stride + q) * pass.out_sample;
      const Lanes& a_re = lanes(pass.in_re + in);
      const Lanes& a_im = lanes(pass.in_im + in);
      const Lanes& b_re = lanes(pass.in_re + in + in_step);
      const Lanes& b_im = lanes(pass.in_im + in + in_step);
      lanes(pass.out_re + out) = a_re + b_re;
      lanes(pass.out_im + out) = a_im + b_im;
      store_product(pass, out + out_step, {a_re - b_re, a_im - b_im}, w[0], w[1]);
    }
  }
}

BEVLOC_TARGET_CLONES void radix4(const Pass& pass) {
  const std::ptrdiff_t in_step = static_cast<std::ptrdiff_t>(pass.groups) * pass.stride * kLanes;
  const std::ptrdiff_t out_step = pass.stride * pass.out_sample;
  for (int p = 0; p < pass.groups; ++p) {
    const float* w = pass.twiddles + 6 * p;
    for (int q = 0; q < pass.stride; ++q) {
      const float* re = pass.in_re + static_cast<std::ptrdiff_t>(p * pass.stride + q) * kLanes;
      const float* im = pass.in_im + static_cast<std::ptrdiff_t>(p * pass.stride + q) * kLanes;
      const std::ptrdiff_t out = (4 * p * pass.stride + q) * pass.out_sample;
      const Complex even_sum{lanes(re) + lanes(re + 2 * in_step),
                             lanes(im) + lanes(im + 2 * in_step)};
      const Complex even_gap{lanes(re) - lanes(re + 2 * in_step),
                             lanes(im) - lanes(im + 2 * in_step)};
      const Complex odd_sum{lanes(re + in_step) + lanes(re + 3 * in_step),
                            lanes(im + in_step) + lanes(im + 3 * in_step)};
      const Complex odd_gap{lanes(re + in_step) - lanes(re + 3 * in_step),
                            lanes(im + in_step) - lanes(im + 3 * in_step)};
      lanes(pass.out_re + out) = even_sum.re + odd_sum.re;
      lanes(pass.out_im + out) = even_sum.im + odd_sum.im;
      // Multiplying by -i turns (re, im) into (im, -re).
      store_product(pass, out + out_step, {even_gap.re + odd_gap.im, even_gap.im - odd_gap.re},
                    w[0], w[1]);
      store_product(pass, out + 2 * out_step, {even_sum.re - odd_sum.re, even_sum.im - odd_sum.im},
                    w[2], w[3]);
      store_product(pass, out + 3 * out_step, {even_gap.re - odd_gap.im, even_gap.im + odd_gap.re},
                    w[4], w[5]);
    }
  }
}

/// The first pass for samples whose second half is zero; that half is not read.
BEVLOC_TARGET_CLONES void radix4_of_half(const Pass& pass) {
  const std::ptrdiff_t in_step = static_cast<std::ptrdiff_t>(pass.groups) * kLanes;
  for (int p = 0; p < pass.groups; ++p) {
    const float* w = pass.twiddles + 6 * p;
    const float* re = pass.in_re + static_cast<std::ptrdiff_t>(p) * kLanes;
    const float* im = pass.in_im + static_cast<std::ptrdiff_t>(p) * kLanes;
    const std::ptrdiff_t out = 4 * p * pass.out_sample;
    const Lanes& a_re = lanes(re);
    const Lanes& a_im = lanes(im);
    const Lanes& b_re = lanes(re + in_step);
    const Lanes& b_im = lanes(im + in_step);
    lanes(pass.out_re + out) = a_re + b_re;
    lanes(pass.out_im + out) = a_im + b_im;
    store_product(pass, out + pass.out_sample, {a_re + b_im, a_im - b_re}, w[0], w[1]);
    store_product(pass, out + 2 * pass.out_sample, {a_re - b_re, a_im - b_im}, w[2], w[3]);
    store_product(pass, out + 3 * pass.out_sample, {a_re - b_im, a_im + b_re}, w[4], w[5]);
  }
}

/// Cosine and sine of 72 and 144 degrees.
constexpr float kCos1 = 0.309016994374947424F;
constexpr float kCos2 = -0.809016994374947424F;
constexpr float kSin1 = 0.951056516295153572F;
constexpr float kSin2 = 0.587785252292473129F;

BEVLOC_TARGET_CLONES void radix5(const Pass& pass) {
  const std::ptrdiff_t in_step = static_cast<std::ptrdiff_t>(pass.groups) * pass.stride * kLanes;
  const std::ptrdiff_t out_step = pass.stride * pass.out_sample;
  for (int p = 0; p < pass.groups; ++p) {
    const float* w = pass.twiddles + 8 * p;
    for (int q = 0; q < pass.stride; ++q) {
      const float* re = pass.in_re + static_cast<std::ptrdiff_t>(p * pass.stride + q) * kLanes;
      const float* im = pass.in_im + static_cast<std::ptrdiff_t>(p * pass.stride + q) * kLanes;
      const std::ptrdiff_t out = (5 * p * pass.stride + q) * pass.out_sample;
      const Lanes& a_re = lanes(re);
      const Lanes& a_im = lanes(im);
      const Complex sum1{lanes(re + in_step) + lanes(re + 4 * in_step),
                         lanes(im + in_step) + lanes(im + 4 * in_step)};
      const Complex gap1{lanes(re + in_step) - lanes(re + 4 * in_step),
                         lanes(im + in_step) - lanes(im + 4 * in_step)};
      const Complex sum2{lanes(re + 2 * in_step) + lanes(re + 3 * in_step),
                         lanes(im + 2 * in_step) + lanes(im + 3 * in_step)};
      const Complex gap2{lanes(re + 2 * in_step) - lanes(re + 3 * in_step),
                         lanes(im + 2 * in_step) - lanes(im + 3 * in_step)};
      const Complex even1{a_re + kCos1 * sum1.re + kCos2 * sum2.re,
                          a_im + kCos1 * sum1.im + kCos2 * sum2.im};
      const Complex even2{a_re + kCos2 * sum1.re + kCos1 * sum2.re,
                          a_im + kCos2 * sum1.im + kCos1 * sum2.im};
      const Complex odd1{kSin1 * gap1.re + kSin2 * gap2.re, kSin1 * gap1.im + kSin2 * gap2.im};
      const Complex odd2{kSin2 * gap1.re - kSin1 * gap2.re, kSin2 * gap1.im - kSin1 * gap2.im};
      lanes(pass.out_re + out) = a_re + sum1.re + sum2.re;
      lanes(pass.out_im + out) = a_im + sum1.im + sum2.im;
      store_product(pass, out + out_step, {even1.re + odd1.im, even1.im - odd1.re}, w[0], w[1]);
      store_product(pass, out + 2 * out_step, {even2.re + odd2.im, even2.im - odd2.re}, w[2], w[3]);
      store_product(pass, out + 3 * out_step, {even2.re - odd2.im, even2.im + odd2.re}, w[4], w[5]);
      store_product(pass, out + 4 * out_step, {even1.re - odd1.im, even1.im + odd1.re}, w[6], w[7]);
    }
  }
}

template <typename Stage>
Pass pass_of(const Stage& stage, const FftTile& in, float* re, float* im,
             std::ptrdiff_t sample_stride) {
  return {in.re.data(),          in.im.data(), re,           im,
          stage.twiddles.data(), stage.groups, stage.stride, sample_stride};
}

void run(const Pass& pass, int radix) {
  if (radix == 4) {
    radix4(pass);
  } else if (radix == 2) {
    radix2(pass);
  } else {
    radix5(pass);
  }
}

}  // namespace

bool LanesFft::supports(int length) {
  if (length < 1) return false;
  for (const int radix : {2, 5}) {
    while (length % radix == 0) length /= radix;
  }
  return length == 1;
}

int LanesFft::power_of_two_from(int least) {
  int length = 1;
  while (length < least) length *= 2;
  return length;
}

LanesFft::LanesFft(int length) : length_(length), scratch_(length) {
  assert(supports(length));
  int stride = 1;
  for (int left = length; left > 1;) {
    const int radix = left % 4 == 0 ? 4 : left % 2 == 0 ? 2 : 5;
    Stage stage{radix, left / radix, stride, {}};
    for (int p = 0; p < stage.groups; ++p) {
      for (int j = 1; j < radix; ++j) {
        const double angle = -2.0 * std::numbers::pi * p * j / left;
        stage.twiddles.push_back(static_cast<float>(std::cos(angle)));
        stage.twiddles.push_back(static_cast<float>(std::sin(angle)));
      }
    }
    stages_.push_back(std::move(stage));
    stride *= radix;
    left /= radix;
  }
}

void LanesFft::transform(FftTile& tile) {
  assert(tile.re.size() == scratch_.re.size());
  for (const Stage& stage : stages_) {
    run(pass_of(stage, tile, scratch_.re.data(), scratch_.im.data(), kLanes), stage.radix);
    std::swap(tile, scratch_);
  }
}

void LanesFft::transform_half(FftTile& tile) {
  assert(can_halve() && tile.re.size() == scratch_.re.size());
  radix4_of_half(pass_of(stages_[0], tile, scratch_.re.data(), scratch_.im.data(), kLanes));
  std::swap(tile, scratch_);
  for (size_t i = 1; i < stages_.size(); ++i) {
    run(pass_of(stages_[i], tile, scratch_.re.data(), scratch_.im.data(), kLanes),
        stages_[i].radix);
    std::swap(tile, scratch_);
  }
}

void LanesFft::transform_to(FftTile& tile, float* re, float* im, std::ptrdiff_t sample_stride) {
  assert(tile.re.size() == scratch_.re.size() && !stages_.empty());
  for (size_t i = 0; i + 1 < stages_.size(); ++i) {
    run(pass_of(stages_[i], tile, scratch_.re.data(), scratch_.im.data(), kLanes),
        stages_[i].radix);
    std::swap(tile, scratch_);
  }
  run(pass_of(stages_.back(), tile, re, im, sample_stride), stages_.back().radix);
}

}  // namespace bevloc
