#include "pipeline/network/task.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace bevloc::nn {
namespace {

template <typename Element>
void rearrange(const std::vector<int32_t>& source, const std::byte* from, std::byte* to) {
  const int count = static_cast<int>(source.size());
#pragma omp parallel for schedule(static)
  for (int i = 0; i < count; ++i) {
    std::memcpy(to + i * sizeof(Element), from + source[i] * sizeof(Element), sizeof(Element));
  }
}

/// Calls `function` with a null pointer to the C++ type of `type`.
template <typename Function>
void with_type(ElementType type, Function function) {
  switch (type) {
    case ElementType::kUint8:
      return function(static_cast<const uint8_t*>(nullptr));
    case ElementType::kInt8:
      return function(static_cast<const int8_t*>(nullptr));
    default:
      return function(static_cast<const float*>(nullptr));
  }
}

}  // namespace

PrimitiveTask::PrimitiveTask(dnnl::primitive primitive, std::vector<BufferArgument> buffers,
                             std::vector<std::pair<int, dnnl::memory>> constants)
    : primitive_(std::move(primitive)),
      buffers_(std::move(buffers)),
      memories_(std::move(constants)) {}

void PrimitiveTask::bind(std::span<const PlacedBuffer> buffers, const dnnl::memory& scratchpad) {
  for (const BufferArgument& argument : buffers_) {
    memories_.emplace_back(argument.argument,
                           dnnl::memory(argument.desc, scratchpad.get_engine(),
                                        buffers[static_cast<size_t>(argument.buffer)].data));
  }
  memories_.emplace_back(DNNL_ARG_SCRATCHPAD, scratchpad);
  for (const auto& [argument, memory] : memories_) arguments_.push_back({argument, memory.get()});
}

void PrimitiveTask::run(dnnl_stream_t stream) {
  [[maybe_unused]] const dnnl_status_t status = dnnl_primitive_execute(
      primitive_.get(), stream, static_cast<int>(arguments_.size()), arguments_.data());
  assert(status == dnnl_success);
}

RearrangeTask::RearrangeTask(int input, int output, size_t element_bytes,
                             std::vector<int32_t> source)
    : input_(input), output_(output), element_bytes_(element_bytes), source_(std::move(source)) {}

void RearrangeTask::bind(std::span<const PlacedBuffer> buffers, const dnnl::memory&) {
  from_ = buffers[static_cast<size_t>(input_)].data;
  to_ = buffers[static_cast<size_t>(output_)].data;
}

void RearrangeTask::run(dnnl_stream_t) {
  if (element_bytes_ == 1) {
    rearrange<uint8_t>(source_, from_, to_);
  } else {
    rearrange<float>(source_, from_, to_);
  }
}

ViewTask::ViewTask(int input, ElementType input_type, int output, ElementType output_type,
                   int channels, float scale, const ViewEntries& entries)
    : input_(input),
      input_type_(input_type),
      output_(output),
      output_type_(output_type),
      channels_(channels),
      scale_(scale),
      entries_(entries) {}

void ViewTask::bind(std::span<const PlacedBuffer> buffers, const dnnl::memory&) {
  from_ = buffers[static_cast<size_t>(input_)].data;
  to_ = buffers[static_cast<size_t>(output_)].data;
}

void ViewTask::run(dnnl_stream_t) {
  constexpr int kBlock = 250;
  const int cells = entries_.cells();
#pragma omp parallel for schedule(static)
  for (int begin = 0; begin < cells; begin += kBlock) {
    const int end = std::min(begin + kBlock, cells);
    with_type(input_type_, [&](const auto* input) {
      with_type(output_type_, [&](const auto* output) {
        using Input = std::remove_cvref_t<decltype(*input)>;
        using Output = std::remove_cvref_t<decltype(*output)>;
        gather_view(entries_, reinterpret_cast<const Input*>(from_), channels_, scale_, begin, end,
                    reinterpret_cast<Output*>(to_));
      });
    });
  }
}

}  // namespace bevloc::nn
