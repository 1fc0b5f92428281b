// Makes the frames that authenticate an epoch of other frames.
#pragma once

#include <cstdint>
#include <span>

#include "can/secoc/authenticator.h"

namespace bevloc::can {

/// The freshness value rises with every authenticated epoch and must never repeat with the same
/// key: its upper half counts the starts of the sender (next_start_number()). One thread.
class SecocSender {
 public:
  SecocSender(Cmac cmac, uint32_t start_number)
      : authenticator_(std::move(cmac)), freshness_(uint64_t{start_number} << 32U) {}

  /// Returns the authentication of the frames of one epoch, without E2E protection. `frames` are in
  /// the order of their identifiers.
  Frame authenticate(const Message& message, std::span<const Frame> frames, const BaseIds& base);

  /// Returns the upper bits of the latest freshness value, without E2E protection.
  Frame freshness(const Message& message, const BaseIds& base) const;

 private:
  Authenticator authenticator_;
  uint64_t freshness_;
};

}  // namespace bevloc::can
