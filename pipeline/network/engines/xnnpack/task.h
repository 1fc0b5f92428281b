// The tasks of the XNNPACK engine. A task is one unit of work on storages whose addresses are fixed
// at load.
//
// In this engine, activations are channel-last, and 8-bit activations are int8, because XNNPACK
// supports scales per output channel only for int8. A uint8 activation is shifted by -128 and has
// the zero point -128.
#pragma once

#include <cstddef>
#include <span>

#include <pthreadpool.h>

#include "pipeline/network/model/program.h"

namespace bevloc::nn::xnnpack {

/// The element that represents the real value 0.
constexpr int zero_point(ElementType type) {
  return type == ElementType::kUint8 ? -128 : 0;
}

class Task {
 public:
  virtual ~Task() = default;

  /// Gives the task the addresses of all storages. Called once, before run(). Throws LoadError.
  virtual void bind(std::span<std::byte* const> storages, pthreadpool_t threads) = 0;
  /// With a null pool, runs in the caller's thread.
  virtual void run(pthreadpool_t threads) = 0;
};

/// Base of the tasks that run our own code: a loop whose iterations may run in any order. Reads one
/// storage and writes another.
class LoopTask : public Task {
 public:
  /// Each thread takes `block` of the `count` iterations at a time.
  LoopTask(size_t input, size_t output, size_t count, size_t block)
      : input_(input), output_(output), count_(count), block_(block) {}

  void bind(std::span<std::byte* const> storages, pthreadpool_t threads) override;
  void run(pthreadpool_t threads) final;

 protected:
  /// Runs the iterations [begin, end).
  virtual void run_range(size_t begin, size_t end) = 0;

  const std::byte* from() const { return from_; }
  std::byte* to() const { return to_; }

 private:
  size_t input_;
  size_t output_;
  size_t count_;
  size_t block_;
  const std::byte* from_ = nullptr;
  std::byte* to_ = nullptr;
};

}  // namespace bevloc::nn::xnnpack
