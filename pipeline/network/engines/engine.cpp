#include "pipeline/network/engines/engine.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <new>

namespace bevloc::nn {
namespace {

/// Vectorised kernels may read, but not write, past the end of a buffer. XNNPACK reads up to
/// XNN_EXTRA_BYTES, which is 16.
constexpr size_t kReadMarginBytes = 64;

}  // namespace

void Engine::AlignedFree::operator()(std::byte* memory) const {
  ::operator delete[](memory, std::align_val_t{kBufferAlignment});
}

std::vector<std::byte*> Engine::allocate(std::span<const Lifetime> storages) {
  const MemoryPlan plan = plan_memory(storages);
  arena_bytes_ = plan.total_bytes;
  for (const Lifetime& storage : storages) bytes_without_reuse_ += storage.bytes;
  const size_t bytes = arena_bytes_ + kReadMarginBytes;
  arena_.reset(
      static_cast<std::byte*>(::operator new[](bytes, std::align_val_t{kBufferAlignment})));
  std::memset(arena_.get(), 0, bytes);
  std::vector<std::byte*> addresses;
  for (const size_t offset : plan.offsets) addresses.push_back(arena_.get() + offset);
  return addresses;
}

void Engine::add_input(const std::string& name, std::span<std::byte> memory) {
  inputs_.push_back({name, memory});
}

void Engine::add_output(const std::string& name, std::span<std::byte> memory) {
  outputs_.push_back({name, memory});
}

std::span<std::byte> Engine::input(const std::string& name) {
  const auto port = std::ranges::find(inputs_, name, &Port::name);
  assert(port != inputs_.end());
  return port->memory;
}

std::span<const float> Engine::output(const std::string& name) const {
  const auto port = std::ranges::find(outputs_, name, &Port::name);
  assert(port != outputs_.end());
  const std::span<std::byte> memory = port->memory;
  return {reinterpret_cast<const float*>(memory.data()), memory.size() / sizeof(float)};
}

}  // namespace bevloc::nn
