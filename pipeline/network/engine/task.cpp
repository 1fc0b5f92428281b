#include "pipeline/network/engine/task.h"

#include <algorithm>
#include <cassert>

#include "pipeline/network/engine/parallel_for.h"
#include "pipeline/network/kernels/rearrange.h"

namespace bevloc::nn::onednn {

PrimitiveTask::PrimitiveTask(dnnl::primitive primitive, std::vector<BufferArgument> buffers,
                             Constants constants)
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

void OwnTask::bind(std::span<const PlacedBuffer> buffers, const dnnl::memory&) {
  from_ = buffers[static_cast<size_t>(input_)].data;
  to_ = buffers[static_cast<size_t>(output_)].data;
}

RearrangeTask::RearrangeTask(int input, int output, size_t element_bytes,
                             std::vector<int32_t> source)
    : OwnTask(input, output), element_bytes_(element_bytes), source_(std::move(source)) {}

void RearrangeTask::run(dnnl_stream_t) {
  constexpr size_t kBlock = 4096;
  parallel_for(static_cast<int>((source_.size() + kBlock - 1) / kBlock), [this](int block) {
    const size_t begin = static_cast<size_t>(block) * kBlock;
    const size_t end = std::min(begin + kBlock, source_.size());
    rearrange(source_, element_bytes_, from(), to(), begin, end);
  });
}

ViewTask::ViewTask(int input, ElementType input_type, int output, ElementType output_type,
                   int channels, float scale, const ViewEntries& entries)
    : OwnTask(input, output),
      input_type_(input_type),
      output_type_(output_type),
      channels_(channels),
      scale_(scale),
      entries_(entries) {}

void ViewTask::run(dnnl_stream_t) {
  constexpr int kBlock = 250;
  const int cells = entries_.cells();
  parallel_for((cells + kBlock - 1) / kBlock, [this, cells](int block) {
    const int begin = block * kBlock;
    const int end = std::min(begin + kBlock, cells);
    gather_view(entries_, input_type_, from(), channels_, scale_, begin, end, output_type_, to());
  });
}

}  // namespace bevloc::nn::onednn
