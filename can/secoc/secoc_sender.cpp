#include "can/secoc/secoc_sender.h"

#include "can/messages/secoc_messages.h"

namespace bevloc::can {

Frame SecocSender::authenticate(const Message& message, std::span<const Frame> frames,
                                const BaseIds& base) {
  ++freshness_;
  Frame frame = blank_frame(message, base);
  insert_raw(frame, secoc::kFreshnessLow, static_cast<int64_t>(freshness_ & 0xFFFF));
  // If OpenSSL fails, the code is 0 and the receiver refuses the epoch, as it must.
  const uint32_t mac = authenticator_.mac(message, freshness_, frames).value_or(0);
  insert_raw(frame, secoc::kMac, mac);
  return frame;
}

Frame SecocSender::freshness(const Message& message, const BaseIds& base) const {
  Frame frame = blank_frame(message, base);
  insert_raw(frame, secoc::kFreshnessHigh, static_cast<int64_t>(freshness_ >> 16U));
  return frame;
}

}  // namespace bevloc::can
