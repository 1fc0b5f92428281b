#include "pipeline/network/engines/xnnpack/movement.h"

#include <cstring>

#include "pipeline/network/kernels/rearrange.h"

namespace bevloc::nn::xnnpack {
namespace {

constexpr size_t kBlockBytes = 16384;
constexpr std::byte kSignBit{0x80};

/// The dimensions of an activation [n, c, h, w].
struct Dims {
  explicit Dims(const Value& value)
      : channels(static_cast<size_t>(value.dims[1])),
        rows(static_cast<size_t>(value.dims[2])),
        cols(static_cast<size_t>(value.dims[3])),
        all_rows(static_cast<size_t>(value.dims[0]) * rows) {}

  /// Index of the first element of a channel in a row, in [n, c, h, w] order. Rows are counted over
  /// all images.
  size_t planar(size_t row, size_t channel) const {
    return ((row / rows * channels + channel) * rows + row % rows) * cols;
  }
  /// The same in channel-last order.
  size_t channel_last(size_t row, size_t channel) const { return row * cols * channels + channel; }

  size_t channels, rows, cols, all_rows;
};

class ImportTask : public LoopTask {
 public:
  ImportTask(const Value& value, size_t from, size_t to)
      : LoopTask(from, to, Dims(value).all_rows, 1), dims_(value), type_(value.type) {}

 private:
  void run_range(size_t begin, size_t end) override {
    for (size_t row = begin; row < end; ++row) {
      for (size_t channel = 0; channel < dims_.channels; ++channel) {
        if (type_ == ElementType::kFloat32) {
          copy<float>(row, channel);
        } else {
          copy<std::byte>(row, channel);
        }
      }
      if (type_ == ElementType::kUint8) {
        std::byte* const line = to() + dims_.channel_last(row, 0);
        shift_by_128(line, line, dims_.cols * dims_.channels);
      }
    }
  }

  template <typename Element>
  void copy(size_t row, size_t channel) const {
    const auto* const source =
        reinterpret_cast<const Element*>(from()) + dims_.planar(row, channel);
    auto* const target = reinterpret_cast<Element*>(to()) + dims_.channel_last(row, channel);
    for (size_t col = 0; col < dims_.cols; ++col) target[col * dims_.channels] = source[col];
  }

  Dims dims_;
  ElementType type_;
};

class ExportTask : public LoopTask {
 public:
  ExportTask(const Value& value, size_t from, size_t to)
      : LoopTask(from, to, Dims(value).all_rows, 1),
        dims_(value),
        is_float_(value.type == ElementType::kFloat32),
        scale_(value.scale),
        zero_(zero_point(value.type)) {}

 private:
  void run_range(size_t begin, size_t end) override {
    for (size_t row = begin; row < end; ++row) {
      for (size_t channel = 0; channel < dims_.channels; ++channel) {
        if (is_float_) {
          convert<float>(row, channel);
        } else {
          convert<int8_t>(row, channel);
        }
      }
    }
  }

  template <typename Element>
  void convert(size_t row, size_t channel) const {
    const float zero = static_cast<float>(zero_);
    const auto* const source =
        reinterpret_cast<const Element*>(from()) + dims_.channel_last(row, channel);
    float* const target = reinterpret_cast<float*>(to()) + dims_.planar(row, channel);
    for (size_t col = 0; col < dims_.cols; ++col) {
      target[col] = scale_ * (static_cast<float>(source[col * dims_.channels]) - zero);
    }
  }

  Dims dims_;
  bool is_float_;
  float scale_;
  int zero_;
};

class ShiftTask : public LoopTask {
 public:
  ShiftTask(size_t from, size_t to, size_t bytes) : LoopTask(from, to, bytes, kBlockBytes) {}

 private:
  void run_range(size_t begin, size_t end) override {
    shift_by_128(from() + begin, to() + begin, end - begin);
  }
};

class RearrangeTask : public LoopTask {
 public:
  RearrangeTask(size_t from, size_t to, size_t element_bytes, std::vector<int32_t> source)
      : LoopTask(from, to, source.size(), kBlockBytes / element_bytes),
        element_bytes_(element_bytes),
        source_(std::move(source)) {}

 private:
  void run_range(size_t begin, size_t end) override {
    rearrange(source_, element_bytes_, from(), to(), begin, end);
  }

  size_t element_bytes_;
  std::vector<int32_t> source_;
};

class ChannelCopyTask : public LoopTask {
 public:
  ChannelCopyTask(size_t pixels, size_t from, size_t from_bytes, size_t to, size_t to_bytes,
                  size_t offset)
      : LoopTask(from, to, pixels, kBlockBytes / to_bytes + 1),
        from_bytes_(from_bytes),
        to_bytes_(to_bytes),
        offset_(offset) {}

 private:
  void run_range(size_t begin, size_t end) override {
    for (size_t pixel = begin; pixel < end; ++pixel) {
      std::memcpy(to() + pixel * to_bytes_ + offset_, from() + pixel * from_bytes_, from_bytes_);
    }
  }

  size_t from_bytes_;
  size_t to_bytes_;
  size_t offset_;
};

/// For each element in [n, c, h, w] order, its index in channel-last order.
std::vector<size_t> channel_last_indices(const Value& value) {
  const Dims dims(value);
  std::vector<size_t> indices(dims.all_rows * dims.channels * dims.cols);
  for (size_t row = 0; row < dims.all_rows; ++row) {
    for (size_t channel = 0; channel < dims.channels; ++channel) {
      for (size_t col = 0; col < dims.cols; ++col) {
        indices[dims.planar(row, channel) + col] =
            dims.channel_last(row, channel) + col * dims.channels;
      }
    }
  }
  return indices;
}

}  // namespace

void shift_by_128(const std::byte* from, std::byte* to, size_t bytes) {
#pragma GCC ivdep
  for (size_t i = 0; i < bytes; ++i) to[i] = from[i] ^ kSignBit;
}

std::unique_ptr<Task> import_input(const Value& value, size_t from, size_t to) {
  return std::make_unique<ImportTask>(value, from, to);
}

std::unique_ptr<Task> export_output(const Value& value, size_t from, size_t to) {
  return std::make_unique<ExportTask>(value, from, to);
}

std::unique_ptr<Task> shift_by_128(size_t from, size_t to, size_t bytes) {
  return std::make_unique<ShiftTask>(from, to, bytes);
}

std::unique_ptr<Task> rearrangement(const RearrangeStep& step, const Value& input,
                                    const Value& output, size_t from, size_t to) {
  const std::vector<size_t> from_index = channel_last_indices(input);
  const std::vector<size_t> to_index = channel_last_indices(output);
  std::vector<int32_t> in_memory_order(to_index.size());
  for (size_t i = 0; i < to_index.size(); ++i) {
    in_memory_order[to_index[i]] =
        static_cast<int32_t>(from_index[static_cast<size_t>(step.source[i])]);
  }
  return std::make_unique<RearrangeTask>(from, to, size_in_bytes(output.type),
                                         std::move(in_memory_order));
}

std::unique_ptr<Task> channel_copy(size_t pixels, size_t from, size_t from_bytes, size_t to,
                                   size_t to_bytes, size_t offset) {
  return std::make_unique<ChannelCopyTask>(pixels, from, from_bytes, to, to_bytes, offset);
}

}  // namespace bevloc::nn::xnnpack
