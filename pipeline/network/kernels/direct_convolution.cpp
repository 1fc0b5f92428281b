#include "pipeline/network/kernels/direct_convolution.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "common/target_clones.h"

namespace bevloc::nn {
namespace {

/// A word is four input channels of one pixel, the unit that the strip kernels read.
constexpr int kWordBytes = 4;
static_assert(DirectConvolution::kMostPlanes == kWordBytes);

/// Kernels take unsigned or signed bytes. An XOR with 128 adds 128 to a signed byte, which makes it
/// unsigned, and subtracts 128 from an unsigned one.
constexpr int kSignOffset = 128;

int round_up(int number, int unit) {
  return (number + unit - 1) / unit * unit;
}

size_t rounded_up_to_line(size_t bytes) {
  return (bytes + kCacheLineBytes - 1) / kCacheLineBytes * kCacheLineBytes;
}

bool is_signed(const Value& value) {
  return value.type == ElementType::kInt8;
}

int as_int(int64_t number) {
  return static_cast<int>(number);
}

/// Real value of one unit of the channel's sum.
float unit_of_sum(const ConvStep& step, const Value& input, int channel) {
  return step.weight_scale[static_cast<size_t>(channel)] * input.scale;
}

/// The initial value of the channel's sum: its bias, minus what the offset of the input bytes adds
/// to the sum.
int32_t start_of(const ConvStep& step, const Value& input, int channel, int input_offset) {
  int32_t start = 0;
  if (!step.bias.empty()) {
    const float bias = step.bias[static_cast<size_t>(channel)];
    start = static_cast<int32_t>(std::lround(bias / unit_of_sum(step, input, channel)));
  }
  const std::span<const int8_t> weights = int8_weights(step);
  const auto count = weights.size() / static_cast<size_t>(step.weights.shape[0]);
  for (const int8_t weight : weights.subspan(static_cast<size_t>(channel) * count, count)) {
    start -= input_offset * weight;
  }
  return start;
}

Requantizer make_requantizer(const ConvStep& step, const Value& input, const Value& output,
                             const Value* residual) {
  Requantizer requantizer;
  requantizer.channels = as_int(output.dims[1]);
  for (int c = 0; c < requantizer.channels; ++c) {
    requantizer.scale.push_back(unit_of_sum(step, input, c) / output.scale);
  }
  requantizer.output = output.type;
  requantizer.relu = step.relu;
  if (residual != nullptr) {
    requantizer.residual = residual->type;
    requantizer.residual_scale = residual->scale / output.scale;
  }
  return requantizer;
}

/// Interleaves a row of four planes to words of four channels, and XORs each byte with `flip`.
BEVLOC_TARGET_CLONES void interleave(const uint8_t* const* planes, int cols, uint8_t flip,
                                     uint8_t* line) {
  const uint8_t* const a = planes[0];
  const uint8_t* const b = planes[1];
  const uint8_t* const c = planes[2];
  const uint8_t* const d = planes[3];
  for (int col = 0; col < cols; ++col) {
    line[4 * col] = a[col] ^ flip;
    line[4 * col + 1] = b[col] ^ flip;
    line[4 * col + 2] = c[col] ^ flip;
    line[4 * col + 3] = d[col] ^ flip;
  }
}

/// XORs each byte with `flip`.
BEVLOC_TARGET_CLONES void flip_bytes(const uint8_t* from, int count, uint8_t flip, uint8_t* line) {
#pragma GCC unroll 4
  for (int i = 0; i < count; ++i) line[i] = from[i] ^ flip;
}

}  // namespace

/// The input rows that an output row needs, padded with zeros ("lines"). Each line is written once
/// and serves all output rows that read it. `scratch` holds the last kernel_rows_ lines.
class DirectConvolution::Lines {
 public:
  Lines(const DirectConvolution& conv, const std::byte* image, std::byte* scratch)
      : conv_(conv),
        image_(reinterpret_cast<const uint8_t*>(image)),
        scratch_(reinterpret_cast<uint8_t*>(scratch)) {}

  /// The lines of one output row, from top to bottom. Call it for ascending rows.
  const uint8_t* const* of(int out_row) {
    const int top = out_row * conv_.stride_rows_ - conv_.pad_top_;
    for (int k = 0; k < conv_.kernel_rows_; ++k) lines_[k] = line(top + k);
    return lines_;
  }

  static constexpr int kMostRows = 7;

 private:
  const uint8_t* line(int row) {
    if (conv_.reads_in_place()) return pixels(row);
    const int rows = conv_.kernel_rows_;
    const int slot = ((row % rows) + rows) % rows;
    uint8_t* const padded = scratch_ + static_cast<size_t>(slot) * conv_.line_bytes();
    if (row >= written_until_) {
      write(row, padded);
      written_until_ = row + 1;
    }
    return padded;
  }

  const uint8_t* pixels(int row) const {
    return image_ + static_cast<size_t>(row) * conv_.in_cols_ * conv_.in_channels_;
  }

  void write(int row, uint8_t* line) const {
    if (row < 0 || row >= conv_.in_rows_) {
      std::memset(line, conv_.flip_, conv_.line_bytes());
      return;
    }
    const auto before = static_cast<size_t>(conv_.pad_left_) * conv_.line_channels_;
    const auto until = before + static_cast<size_t>(conv_.in_cols_) * conv_.line_channels_;
    std::memset(line, conv_.flip_, before);
    std::memset(line + until, conv_.flip_, conv_.line_bytes() - until);
    line += before;
    if (conv_.order_ == ChannelOrder::kPlanes) return write_planes(row, line);
    write_pixels(row, line);
  }

  /// The bytes of channels beyond those of the input stay as they are, because their weights are 0.
  void write_pixels(int row, uint8_t* line) const {
    const int channels = conv_.in_channels_;
    const uint8_t* from = pixels(row);
    if (channels == conv_.line_channels_) {
      return flip_bytes(from, conv_.in_cols_ * channels, conv_.flip_, line);
    }
    for (int col = 0; col < conv_.in_cols_; ++col) {
      for (int c = 0; c < channels; ++c) line[c] = static_cast<uint8_t>(from[c] ^ conv_.flip_);
      line += conv_.line_channels_;
      from += channels;
    }
  }

  /// Repeats the last plane for missing channels, whose weights are 0.
  void write_planes(int row, uint8_t* line) const {
    const uint8_t* planes[kWordBytes];
    for (int c = 0; c < kWordBytes; ++c) {
      const int plane = std::min(c, conv_.in_channels_ - 1);
      planes[c] = image_ + (static_cast<size_t>(plane) * conv_.in_rows_ + row) * conv_.in_cols_;
    }
    interleave(planes, conv_.in_cols_, conv_.flip_, line);
  }

  const DirectConvolution& conv_;
  const uint8_t* image_;
  uint8_t* scratch_;
  const uint8_t* lines_[kMostRows] = {};
  int written_until_ = std::numeric_limits<int>::min();  ///< earlier rows are in `scratch`
};

bool DirectConvolution::can_run(const ConvStep& step, const Value& input,
                                const KernelSet& kernels) {
  const bool is_plain = step.groups == 1 && step.dilations == std::array<int64_t, 2>{1, 1} &&
                        step.weights.shape[2] <= Lines::kMostRows;
  if (!is_plain || step.weights.type != ElementType::kInt8 || !is_8_bit(input.type)) return false;
  return std::ranges::all_of(int8_weights(step), [&kernels](int8_t weight) {
    return std::abs(weight) <= kernels.largest_weight;
  });
}

DirectConvolution::DirectConvolution(const ConvStep& step, const Value& input, const Value& output,
                                     const Value* residual, const KernelSet& kernels,
                                     ChannelOrder order)
    : order_(order),
      images_(as_int(input.dims[0])),
      in_rows_(as_int(input.dims[2])),
      in_cols_(as_int(input.dims[3])),
      in_channels_(as_int(input.dims[1])),
      line_channels_(round_up(in_channels_, kWordBytes)),
      out_rows_(as_int(output.dims[2])),
      out_cols_(as_int(output.dims[3])),
      kernel_rows_(as_int(step.weights.shape[2])),
      kernel_cols_(as_int(step.weights.shape[3])),
      stride_rows_(as_int(step.strides[0])),
      stride_cols_(as_int(step.strides[1])),
      pad_top_(as_int(step.pads[0])),
      pad_left_(as_int(step.pads[1])),
      flip_(is_signed(input) == kernels.takes_signed ? 0 : kSignOffset),
      requantizer_(make_requantizer(step, input, output, residual)),
      requantize_(requantize_for(requantizer_, residual != nullptr)) {
  assert(can_run(step, input, kernels));
  assert(order == ChannelOrder::kLast || in_channels_ <= kMostPlanes);
  make_groups(step, kernels);
  starts_.resize(static_cast<size_t>(sums_per_pixel_));
  const int input_offset = kSignOffset * (int{is_signed(input)} - int{kernels.takes_signed});
  for (int c = 0; c < requantizer_.channels; ++c) {
    starts_[static_cast<size_t>(c)] = start_of(step, input, c, input_offset);
  }
}

/// Divides the output channels into as few groups as possible, of about the same width.
void DirectConvolution::make_groups(const ConvStep& step, const KernelSet& kernels) {
  const bool has_halves = kernels.kernels[1][1] != nullptr;
  const int unit = has_halves ? kernels.lanes / 2 : kernels.lanes;
  const int units = round_up(requantizer_.channels, unit) / unit;
  const int units_per_vector = kernels.lanes / unit;
  const int most = KernelSet::kMostVectors * units_per_vector;
  const int groups = round_up(units, most) / most;
  int first = 0;
  for (int left = groups; left > 0; --left) {
    // All groups but the last have whole vectors; only the last may have a half one.
    const int share = (units - first + left - 1) / left;
    const int take = left == 1 ? share : std::min(round_up(share, units_per_vector), most);
    const StripKernel kernel = kernels.kernels[take / units_per_vector][take % units_per_vector];
    groups_.push_back(make_group(step, kernels, kernel, first * unit, take * unit));
    first += take;
  }
  sums_per_pixel_ = units * unit;
}

/// Packs the weights as KernelStrip wants them. Channels beyond those of the model get weight 0.
DirectConvolution::Group DirectConvolution::make_group(const ConvStep& step,
                                                       const KernelSet& kernels, StripKernel kernel,
                                                       int first_channel, int lanes) const {
  assert(kernel != nullptr);
  const std::span<const int8_t> from = int8_weights(step);
  Group group{kernel, first_channel, lanes, {}};
  const int step_bytes = kernels.step_words * kWordBytes;
  const int steps = round_up(kernel_cols_ * line_channels_, step_bytes) / step_bytes;
  group.weights.resize(static_cast<size_t>(kernel_rows_) * steps * lanes * step_bytes);
  const int last_channel = std::min(first_channel + lanes, requantizer_.channels);
  for (int out = first_channel; out < last_channel; ++out) {
    for (int in = 0; in < in_channels_; ++in) {
      for (int row = 0; row < kernel_rows_; ++row) {
        for (int col = 0; col < kernel_cols_; ++col) {
          const int byte = col * line_channels_ + in;
          const int lane = (row * steps + byte / step_bytes) * lanes + out - first_channel;
          group.weights[static_cast<size_t>(lane * step_bytes + byte % step_bytes)] =
              from[static_cast<size_t>(
                  ((out * in_channels_ + in) * kernel_rows_ + row) * kernel_cols_ + col)];
        }
      }
    }
  }
  return group;
}

/// Whether the kernels can read the input itself: it needs no padding, and its channels have the
/// sign that the kernels take and fill whole words.
bool DirectConvolution::reads_in_place() const {
  return kernel_rows_ == 1 && kernel_cols_ == 1 && pad_top_ == 0 && pad_left_ == 0 &&
         order_ == ChannelOrder::kLast && flip_ == 0 && line_channels_ == in_channels_;
}

size_t DirectConvolution::line_bytes() const {
  const int read_cols = (out_cols_ - 1) * stride_cols_ + kernel_cols_;
  return static_cast<size_t>(std::max(read_cols, pad_left_ + in_cols_)) * line_channels_;
}

size_t DirectConvolution::scratch_bytes() const {
  return rounded_up_to_line(static_cast<size_t>(kernel_rows_) * line_bytes()) +
         static_cast<size_t>(out_cols_) * sums_per_pixel_ * sizeof(int32_t);
}

void DirectConvolution::run(const std::byte* input, const std::byte* residual, std::byte* output,
                            int begin, int end, std::byte* scratch) const {
  const auto image_bytes = static_cast<size_t>(in_rows_) * in_cols_ * in_channels_;
  const auto row_elements = static_cast<size_t>(out_cols_) * requantizer_.channels;
  const size_t output_bytes = row_elements * size_in_bytes(requantizer_.output);
  const size_t residual_bytes = row_elements * size_in_bytes(requantizer_.residual);
  auto* const sums = reinterpret_cast<int32_t*>(
      scratch + rounded_up_to_line(static_cast<size_t>(kernel_rows_) * line_bytes()));
  for (int row = begin; row < end;) {
    const int image = row / out_rows_;
    Lines lines(*this, input + image * image_bytes, scratch);
    for (const int last = std::min(end, (image + 1) * out_rows_); row < last; ++row) {
      KernelStrip strip{.lines = lines.of(row - image * out_rows_),
                        .rows = kernel_rows_,
                        .words = kernel_cols_ * line_channels_ / kWordBytes,
                        .pixel_step = stride_cols_ * line_channels_,
                        .pixels = out_cols_,
                        .sums_step = sums_per_pixel_};
      for (const Group& group : groups_) {
        strip.weights = group.weights.data();
        strip.start = starts_.data() + group.first_channel;
        strip.sums = sums + group.first_channel;
        group.kernel(strip);
      }
      requantize_(requantizer_,
                  {.sums = sums,
                   .sums_step = sums_per_pixel_,
                   .pixels = out_cols_,
                   .residual = residual == nullptr ? nullptr : residual + row * residual_bytes,
                   .output = output + row * output_bytes});
    }
  }
}

}  // namespace bevloc::nn
