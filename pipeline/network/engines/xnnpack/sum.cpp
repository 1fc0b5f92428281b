#include "pipeline/network/engines/xnnpack/sum.h"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "common/target_clones.h"

namespace bevloc::nn::xnnpack {
namespace {

/// The arguments of a kernel. Scales are relative to the scale of the output.
struct Arguments {
  const std::byte* left = nullptr;
  const std::byte* right = nullptr;
  std::byte* output = nullptr;
  const float* left_scale = nullptr;  ///< by channel
  float right_scale = 0.0F;
  float left_zero = 0.0F;
  float right_zero = 0.0F;
  float output_zero = 0.0F;
  float lowest = 0.0F;  ///< before the output's zero point is added
  float highest = 0.0F;
  size_t channels = 0;
};

/// Stands for the type of the right term where there is none.
struct Nothing {};

/// Adding and subtracting 1.5 * 2^23 rounds a small float to the nearest even integer.
constexpr float kRounder = 12582912.0F;

template <typename Left, typename Right, typename Output>
[[gnu::always_inline]] inline void sum_pixels(const Arguments& a, size_t begin, size_t end) {
  const auto [left_scale, right_scale, left_zero, right_zero, output_zero, lowest, highest] =
      std::tuple(a.left_scale, a.right_scale, a.left_zero, a.right_zero, a.output_zero, a.lowest,
                 a.highest);
  for (size_t pixel = begin; pixel < end; ++pixel) {
    const size_t first = pixel * a.channels;
    const auto* const left = reinterpret_cast<const Left*>(a.left) + first;
    const auto* const right = reinterpret_cast<const Right*>(a.right) + first;
    auto* const output = reinterpret_cast<Output*>(a.output) + first;
#pragma GCC ivdep
    for (size_t c = 0; c < a.channels; ++c) {
      float sum = left_scale[c] * (static_cast<float>(left[c]) - left_zero);
      if constexpr (!std::is_same_v<Right, Nothing>) {
        sum += right_scale * (static_cast<float>(right[c]) - right_zero);
      }
      sum = sum < lowest ? lowest : sum;
      if constexpr (std::is_same_v<Output, float>) {
        output[c] = sum;
      } else {
        sum = sum > highest ? highest : sum;
        output[c] = static_cast<Output>((sum + kRounder) - kRounder + output_zero);
      }
    }
  }
}

// Only functions, not templates, can be compiled for several instruction sets. So each combination
// of types has a function of its own.
using Kernel = void (*)(const Arguments& arguments, size_t begin, size_t end);
#define BEVLOC_SUM(name, Left, Right, Output)                                            \
  BEVLOC_TARGET_CLONES void name(const Arguments& arguments, size_t begin, size_t end) { \
    sum_pixels<Left, Right, Output>(arguments, begin, end);                              \
  }
BEVLOC_SUM(int8_to_int8, int8_t, Nothing, int8_t)
BEVLOC_SUM(int8_to_float, int8_t, Nothing, float)
BEVLOC_SUM(int8_int8_to_int8, int8_t, int8_t, int8_t)
BEVLOC_SUM(int8_int8_to_float, int8_t, int8_t, float)
BEVLOC_SUM(int8_float_to_int8, int8_t, float, int8_t)
BEVLOC_SUM(int8_float_to_float, int8_t, float, float)
BEVLOC_SUM(float_to_int8, float, Nothing, int8_t)
BEVLOC_SUM(float_to_float, float, Nothing, float)
BEVLOC_SUM(float_int8_to_int8, float, int8_t, int8_t)
BEVLOC_SUM(float_int8_to_float, float, int8_t, float)
BEVLOC_SUM(float_float_to_int8, float, float, int8_t)
BEVLOC_SUM(float_float_to_float, float, float, float)
#undef BEVLOC_SUM

/// By the types of left (int8, float), right (none, int8, float) and output (int8, float).
constexpr Kernel kKernels[2][3][2] = {
    {{int8_to_int8, int8_to_float},
     {int8_int8_to_int8, int8_int8_to_float},
     {int8_float_to_int8, int8_float_to_float}},
    {{float_to_int8, float_to_float},
     {float_int8_to_int8, float_int8_to_float},
     {float_float_to_int8, float_float_to_float}},
};

size_t is_float(ElementType type) {
  return type == ElementType::kFloat32 ? 1 : 0;
}

Kernel kernel_for(const Sum& sum) {
  const size_t right = sum.right ? 1 + is_float(sum.right->type) : 0;
  return kKernels[is_float(sum.left.type)][right][is_float(sum.output_type)];
}

/// Number of pixels that a thread processes at a time.
constexpr size_t kBlock = 256;

class SumTask : public LoopTask {
 public:
  explicit SumTask(const Sum& sum);

  void bind(std::span<std::byte* const> storages, pthreadpool_t threads) override;

 private:
  void run_range(size_t begin, size_t end) override { kernel_(arguments_, begin, end); }

  Kernel kernel_;
  Arguments arguments_;
  std::vector<float> left_scale_;
  size_t right_storage_;
};

SumTask::SumTask(const Sum& sum)
    : LoopTask(sum.left.storage, sum.output, sum.pixels, kBlock),
      kernel_(kernel_for(sum)),
      left_scale_(sum.left.scale),
      right_storage_(sum.right ? sum.right->storage : sum.left.storage) {
  left_scale_.resize(sum.channels, sum.left.scale[0]);
  for (float& scale : left_scale_) scale /= sum.output_scale;
  arguments_.channels = sum.channels;
  arguments_.left_zero = static_cast<float>(zero_point(sum.left.type));
  if (sum.right) {
    arguments_.right_zero = static_cast<float>(zero_point(sum.right->type));
    arguments_.right_scale = sum.right->scale[0] / sum.output_scale;
  }
  const int zero = zero_point(sum.output_type);
  const bool rounds = sum.output_type != ElementType::kFloat32;
  arguments_.output_zero = static_cast<float>(zero);
  arguments_.lowest = rounds ? static_cast<float>(std::numeric_limits<int8_t>::min() - zero)
                             : -std::numeric_limits<float>::infinity();
  arguments_.highest = static_cast<float>(std::numeric_limits<int8_t>::max() - zero);
  if (sum.relu) arguments_.lowest = 0.0F;
}

void SumTask::bind(std::span<std::byte* const> storages, pthreadpool_t threads) {
  LoopTask::bind(storages, threads);
  arguments_.left = from();
  arguments_.right = storages[right_storage_];
  arguments_.output = to();
  arguments_.left_scale = left_scale_.data();
}

}  // namespace

std::unique_ptr<Task> make_sum(const Sum& sum) {
  return std::make_unique<SumTask>(sum);
}

}  // namespace bevloc::nn::xnnpack
