// Computes the authentication of the frames of one epoch.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "can/messages/message.h"
#include "can/secoc/cmac.h"

namespace bevloc::can {

/// Does not allocate after construction. One thread.
class Authenticator {
 public:
  static constexpr size_t kMaxFrames = 16;

  explicit Authenticator(Cmac cmac) : cmac_(std::move(cmac)) {}

  /// Returns the raw value of secoc::kMac for at most kMaxFrames frames, or nothing when OpenSSL
  /// fails.
  std::optional<uint32_t> mac(const Message& message, uint64_t freshness,
                              std::span<const Frame> frames);

 private:
  static constexpr size_t kHeader = 1 + 8;
  static constexpr size_t kFrameBytes = 2 + 1 + kMaxFdLength;

  Cmac cmac_;
  std::array<uint8_t, kHeader + kMaxFrames * kFrameBytes> bytes_{};
};

}  // namespace bevloc::can
