// One unit of work of the oneDNN engine, on buffers whose places are fixed at load.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <dnnl.hpp>

#include "pipeline/network/program.h"
#include "pipeline/network/view_transform.h"

namespace bevloc::nn::onednn {

using MemoryDesc = dnnl::memory::desc;

/// Where buffers lie, once memory has been planned.
struct PlacedBuffer {
  MemoryDesc desc;
  std::byte* data = nullptr;
};

class Task {
 public:
  virtual ~Task() = default;

  /// Called once, before run().
  virtual void bind(std::span<const PlacedBuffer> buffers, const dnnl::memory& scratchpad) = 0;
  virtual void run(dnnl_stream_t stream) = 0;
};

/// A oneDNN primitive.
class PrimitiveTask : public Task {
 public:
  /// An argument that is a buffer, seen through `desc`.
  struct BufferArgument {
    int argument = 0;
    int buffer = 0;
    MemoryDesc desc;
  };

  PrimitiveTask(dnnl::primitive primitive, std::vector<BufferArgument> buffers,
                std::vector<std::pair<int, dnnl::memory>> constants = {});

  void bind(std::span<const PlacedBuffer> buffers, const dnnl::memory& scratchpad) override;
  void run(dnnl_stream_t stream) override;

 private:
  dnnl::primitive primitive_;
  std::vector<BufferArgument> buffers_;
  std::vector<std::pair<int, dnnl::memory>> memories_;
  std::vector<dnnl_exec_arg_t> arguments_;
};

/// output[i] = input[source[i]] in memory order.
class RearrangeTask : public Task {
 public:
  RearrangeTask(int input, int output, size_t element_bytes, std::vector<int32_t> source);

  void bind(std::span<const PlacedBuffer> buffers, const dnnl::memory& scratchpad) override;
  void run(dnnl_stream_t stream) override;

 private:
  int input_;
  int output_;
  size_t element_bytes_;
  std::vector<int32_t> source_;
  const std::byte* from_ = nullptr;
  std::byte* to_ = nullptr;
};

/// The view transform between channel-last buffers. `entries` must outlive the task.
class ViewTask : public Task {
 public:
  ViewTask(int input, ElementType input_type, int output, ElementType output_type, int channels,
           float scale, const ViewEntries& entries);

  void bind(std::span<const PlacedBuffer> buffers, const dnnl::memory& scratchpad) override;
  void run(dnnl_stream_t stream) override;

 private:
  int input_;
  ElementType input_type_;
  int output_;
  ElementType output_type_;
  int channels_;
  float scale_;
  const ViewEntries& entries_;
  const std::byte* from_ = nullptr;
  std::byte* to_ = nullptr;
};

}  // namespace bevloc::nn::onednn
