#include "pipeline/network/engines/xnnpack/sampling.h"

#include <algorithm>
#include <array>
#include <limits>

#include "pipeline/network/engines/xnnpack/movement.h"
#include "pipeline/network/kernels/nearest_upsample.h"

namespace bevloc::nn::xnnpack {
namespace {

size_t all_rows(const Value& value) {
  return static_cast<size_t>(value.dims[0] * value.dims[2]);
}

/// One iteration computes one output row.
template <typename Element>
class MaxPoolTask : public LoopTask {
 public:
  MaxPoolTask(const MaxPoolStep& step, const Value& input, const Value& output, size_t from,
              size_t to)
      : LoopTask(from, to, all_rows(output), 1),
        step_(step),
        input_(input.dims),
        output_(output.dims) {}

 private:
  void run_range(size_t begin, size_t end) override {
    for (size_t row = begin; row < end; ++row) {
      for (int64_t col = 0; col < output_[3]; ++col) pool(static_cast<int64_t>(row), col);
    }
  }

  /// The cells [first, last) of `length` cells that the window covers.
  static std::array<int64_t, 2> covered(int64_t first, int64_t window, int64_t length) {
    return {std::clamp<int64_t>(first, 0, length), std::clamp<int64_t>(first + window, 0, length)};
  }

  void pool(int64_t row, int64_t col) const {
    const int64_t channels = input_[1];
    const int64_t image = row / output_[2];
    const auto rows =
        covered(row % output_[2] * step_.strides[0] - step_.pads[0], step_.kernel[0], input_[2]);
    const auto cols = covered(col * step_.strides[1] - step_.pads[1], step_.kernel[1], input_[3]);
    Element* const highest = reinterpret_cast<Element*>(to()) + (row * output_[3] + col) * channels;
    std::fill_n(highest, channels, std::numeric_limits<Element>::lowest());
    for (int64_t y = rows[0]; y < rows[1]; ++y) {
      for (int64_t x = cols[0]; x < cols[1]; ++x) {
        const Element* const cell = reinterpret_cast<const Element*>(from()) +
                                    ((image * input_[2] + y) * input_[3] + x) * channels;
        for (int64_t c = 0; c < channels; ++c) highest[c] = std::max(highest[c], cell[c]);
      }
    }
  }

  MaxPoolStep step_;
  std::array<int64_t, 4> input_;
  std::array<int64_t, 4> output_;
};

/// One iteration processes one input row and writes two output rows.
class NearestUpsampleTask : public LoopTask {
 public:
  NearestUpsampleTask(const Value& input, size_t from, size_t to)
      : LoopTask(from, to, all_rows(input), 1),
        cols_(static_cast<size_t>(input.dims[3])),
        pixel_bytes_(static_cast<size_t>(input.dims[1]) * size_in_bytes(input.type)) {}

 private:
  void run_range(size_t begin, size_t end) override {
    upsample_nearest(from(), cols_, pixel_bytes_, begin, end, to());
  }

  size_t cols_;
  size_t pixel_bytes_;
};

/// Interpolates linearly at half-pixel positions: 3/4 of the nearest cell plus 1/4 of its
/// neighbour, along both axes. One iteration computes one output row.
class LinearUpsampleTask : public LoopTask {
 public:
  LinearUpsampleTask(const Value& input, size_t from, size_t to)
      : LoopTask(from, to, 2 * all_rows(input), 1),
        channels_(input.dims[1]),
        rows_(input.dims[2]),
        cols_(input.dims[3]) {}

 private:
  /// The two input cells that output cell `i` depends on along an axis: the nearest and its
  /// neighbour.
  static std::array<int64_t, 2> cells(int64_t i, int64_t length) {
    const int64_t neighbour = i / 2 + (i % 2 == 0 ? -1 : 1);
    return {i / 2, std::clamp<int64_t>(neighbour, 0, length - 1)};
  }

  void run_range(size_t begin, size_t end) override {
    const auto* const source = reinterpret_cast<const float*>(from());
    for (int64_t row = static_cast<int64_t>(begin); row < static_cast<int64_t>(end); ++row) {
      const auto rows = cells(row % (2 * rows_), rows_);
      const int64_t image_row = row / (2 * rows_) * rows_;
      const float* const near = source + (image_row + rows[0]) * cols_ * channels_;
      const float* const far = source + (image_row + rows[1]) * cols_ * channels_;
      float* output = reinterpret_cast<float*>(to()) + row * 2 * cols_ * channels_;
      for (int64_t col = 0; col < 2 * cols_; ++col, output += channels_) {
        const auto cols = cells(col, cols_);
        for (int64_t c = 0; c < channels_; ++c) {
          const int64_t x0 = cols[0] * channels_ + c;
          const int64_t x1 = cols[1] * channels_ + c;
          output[c] = 0.75F * (0.75F * near[x0] + 0.25F * far[x0]) +
                      0.25F * (0.75F * near[x1] + 0.25F * far[x1]);
        }
      }
    }
  }

  int64_t channels_;
  int64_t rows_;
  int64_t cols_;
};

/// One iteration computes one BEV cell.
class ViewTask : public LoopTask {
 public:
  ViewTask(const Value& features, const Value& output, const ViewEntries& entries, size_t from,
           size_t to)
      : LoopTask(from, to, static_cast<size_t>(entries.cells()), kBlock),
        entries_(entries),
        input_type_(features.type),
        output_type_(output.type),
        channels_(static_cast<int>(output.dims[1])),
        scale_(features.scale / output.scale) {}

 private:
  static constexpr size_t kBlock = 250;

  void run_range(size_t begin, size_t end) override {
    gather_view(entries_, input_type_, from(), channels_, scale_, static_cast<int>(begin),
                static_cast<int>(end), output_type_, to());
    if (output_type_ != ElementType::kUint8) return;
    const size_t channels = static_cast<size_t>(channels_);
    std::byte* const cells = to() + begin * channels;
    shift_by_128(cells, cells, (end - begin) * channels);
  }

  const ViewEntries& entries_;
  ElementType input_type_;
  ElementType output_type_;
  int channels_;
  float scale_;
};

}  // namespace

std::unique_ptr<Task> max_pool(const MaxPoolStep& step, const Value& input, const Value& output,
                               size_t from, size_t to) {
  if (input.type == ElementType::kFloat32) {
    return std::make_unique<MaxPoolTask<float>>(step, input, output, from, to);
  }
  return std::make_unique<MaxPoolTask<int8_t>>(step, input, output, from, to);
}

std::unique_ptr<Task> upsampling(bool linear, const Value& input, size_t from, size_t to) {
  if (linear) return std::make_unique<LinearUpsampleTask>(input, from, to);
  return std::make_unique<NearestUpsampleTask>(input, from, to);
}

std::unique_ptr<Task> view_gather(const Value& features, const Value& output,
                                  const ViewEntries& entries, size_t from, size_t to) {
  return std::make_unique<ViewTask>(features, output, entries, from, to);
}

}  // namespace bevloc::nn::xnnpack
