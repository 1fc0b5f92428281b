#include "can/secoc/authenticator.h"

#include <algorithm>
#include <cassert>

namespace bevloc::can {

std::optional<uint32_t> Authenticator::mac(const Message& message, uint64_t freshness,
                                           std::span<const Frame> frames) {
  assert(frames.size() <= kMaxFrames);
  auto next = bytes_.begin();
  const auto put = [&next](uint64_t value, unsigned size) {
    for (unsigned i = size; i-- > 0;) *next++ = static_cast<uint8_t>(value >> (8 * i));
  };
  put(message.data_id, 1);
  put(freshness, 8);
  for (const Frame& frame : frames) {
    put(frame.id, 2);
    put(frame.length, 1);
    next = std::ranges::copy(frame.payload(), next).out;
  }
  Cmac::Tag tag;
  const auto length = static_cast<size_t>(next - bytes_.begin());
  if (!cmac_.compute({bytes_.data(), length}, tag)) return std::nullopt;
  uint32_t raw = 0;
  for (unsigned i = 0; i < 4; ++i) raw |= uint32_t{tag[i]} << (8 * i);
  return raw;
}

}  // namespace bevloc::can
