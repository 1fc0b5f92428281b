// One unit of work of the XNNPACK engine, on storages whose places are fixed at load.
//
// In here activations are channel-last. 8-bit ones are int8, because XNNPACK has scales per output
// channel for int8 only: a uint8 activation is moved down by 128 and has the zero point -128.
#pragma once

#include <cstddef>
#include <span>

#include <pthreadpool.h>

#include "pipeline/network/program.h"

namespace bevloc::nn::xnnpack {

/// The element that stands for the real value 0.
constexpr int zero_point(ElementType type) {
  return type == ElementType::kUint8 ? -128 : 0;
}

class Task {
 public:
  virtual ~Task() = default;

  /// Called once, before run(), with the place of each storage. Throws LoadError.
  virtual void bind(std::span<std::byte* const> storages, pthreadpool_t threads) = 0;
  /// Without a pool in the caller's thread alone.
  virtual void run(pthreadpool_t threads) = 0;
};

/// A loop whose turns may run in any order: from one storage to another.
class LoopTask : public Task {
 public:
  /// Threads take `block` of the `count` turns at a time.
  LoopTask(size_t input, size_t output, size_t count, size_t block)
      : input_(input), output_(output), count_(count), block_(block) {}

  void bind(std::span<std::byte* const> storages, pthreadpool_t threads) override;
  void run(pthreadpool_t threads) final;

 protected:
  virtual void run_turns(size_t begin, size_t end) = 0;

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
