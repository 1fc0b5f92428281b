// The tasks of the oneDNN engine. A task is one unit of work on buffers whose addresses are fixed
// at load.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <dnnl.hpp>

#include "pipeline/network/engine/primitives.h"
#include "pipeline/network/kernels/view_transform.h"
#include "pipeline/network/model/program.h"

namespace bevloc::nn::onednn {

/// A buffer with its address.
struct PlacedBuffer {
  MemoryDesc desc;
  std::byte* data = nullptr;
};

class Task {
 public:
  virtual ~Task() = default;

  /// Gives the task the addresses of all buffers. Called once, before run().
  virtual void bind(std::span<const PlacedBuffer> buffers, const dnnl::memory& scratchpad) = 0;
  virtual void run(dnnl_stream_t stream) = 0;
};

/// Runs a oneDNN primitive.
class PrimitiveTask : public Task {
 public:
  /// An argument of the primitive: a buffer, interpreted with the layout `desc`.
  struct BufferArgument {
    int argument = 0;
    int buffer = 0;
    MemoryDesc desc;
  };

  /// `constants` are further arguments, by argument index.
  PrimitiveTask(dnnl::primitive primitive, std::vector<BufferArgument> buffers,
                Constants constants);

  void bind(std::span<const PlacedBuffer> buffers, const dnnl::memory& scratchpad) override;
  void run(dnnl_stream_t stream) override;

 private:
  dnnl::primitive primitive_;
  std::vector<BufferArgument> buffers_;
  Constants memories_;
  std::vector<dnnl_exec_arg_t> arguments_;
};

/// Base of the tasks that run our own code. Reads one buffer and writes another.
class OwnTask : public Task {
 public:
  OwnTask(int input, int output) : input_(input), output_(output) {}

  void bind(std::span<const PlacedBuffer> buffers, const dnnl::memory& scratchpad) override;

 protected:
  const std::byte* from() const { return from_; }
  std::byte* to() const { return to_; }

 private:
  int input_;
  int output_;
  const std::byte* from_ = nullptr;
  std::byte* to_ = nullptr;
};

/// output[i] = input[source[i]], both in memory order.
class RearrangeTask : public OwnTask {
 public:
  RearrangeTask(int input, int output, size_t element_bytes, std::vector<int32_t> source);

  void run(dnnl_stream_t stream) override;

 private:
  size_t element_bytes_;
  std::vector<int32_t> source_;
};

/// The view transform between channel-last buffers. `entries` must outlive the task.
class ViewTask : public OwnTask {
 public:
  ViewTask(int input, ElementType input_type, int output, ElementType output_type, int channels,
           float scale, const ViewEntries& entries);

  void run(dnnl_stream_t stream) override;

 private:
  ElementType input_type_;
  ElementType output_type_;
  int channels_;
  float scale_;
  const ViewEntries& entries_;
};

}  // namespace bevloc::nn::onednn
