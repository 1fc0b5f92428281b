// The description of a CAN message: its signals, cycle and E2E protection.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "can/bus/frame.h"
#include "can/e2e/e2e.h"
#include "can/messages/signal.h"

namespace bevloc::can {

enum class Sender : uint8_t { kLocalizer, kVehicle };

/// The first identifiers of the LOC_ and of the VEH_ messages. Each message adds its own offset.
struct BaseIds {
  /// Each family of messages has fewer identifiers than this.
  static constexpr uint32_t kFamily = 0x40;
  static constexpr uint32_t kFirst = 1;
  /// The largest base identifier, because identifiers have 11 bits.
  static constexpr uint32_t kLast = 0x800 - kFamily;

  uint32_t localizer = 0x500;
  uint32_t vehicle = 0x400;

  /// Whether no message of one family has an identifier of the other.
  constexpr bool are_apart() const {
    return (localizer > vehicle ? localizer - vehicle : vehicle - localizer) >= kFamily;
  }
};

struct Message {
  std::string_view name;
  Sender sender = Sender::kLocalizer;
  uint32_t id_offset = 0;
  uint8_t length = kMaxClassicLength;
  FrameFormat format = FrameFormat::kClassic;
  int cycle_ms = 0;
  uint16_t data_id = 0;  ///< for the E2E protection, the same for all counter values
  std::span<const Signal* const> signals{};  ///< without the E2E header
  std::string_view comment{};

  constexpr uint32_t id(const BaseIds& base) const {
    return (sender == Sender::kLocalizer ? base.localizer : base.vehicle) + id_offset;
  }
  constexpr E2eProtection protection() const {
    return {data_id, format == FrameFormat::kFd ? E2eProfile::kP05 : E2eProfile::kP02};
  }
};

/// The header of every classic message: E2E profile P02, with the epoch in the nibble that the
/// profile does not use.
inline constexpr Signal kChecksum{
    .name = "CHECKSUM",
    .start_bit = 0,
    .length_bits = 8,
    .max = 255,
    .comment =
        "AUTOSAR E2E profile P02: CRC-8H2F over bytes 1 to the last, then the message's "
        "E2EDataId."};
inline constexpr Signal kCounter{.name = "COUNTER",
                                 .start_bit = 8,
                                 .length_bits = 4,
                                 .max = 15,
                                 .comment = "Counts the frames of this message, 0 to 15."};
inline constexpr Signal kEpoch{
    .name = "EPOCH",
    .start_bit = 12,
    .length_bits = 4,
    .max = 15,
    .comment =
        "The same in all frames of one solution or measurement. Do not combine frames of different "
        "epochs."};
inline constexpr const Signal* kE2eHeader[] = {&kChecksum, &kCounter, &kEpoch};

/// The header of every FD message: E2E profile P05. It needs no epoch, because one frame is a whole
/// solution.
inline constexpr Signal kFdChecksum{
    .name = "CHECKSUM",
    .start_bit = 0,
    .length_bits = 16,
    .max = 65535,
    .comment =
        "AUTOSAR E2E profile P05: CRC-16/CCITT-FALSE over bytes 2 to the last, then the message's "
        "E2EDataId, low byte first."};
inline constexpr Signal kFdCounter{.name = "COUNTER",
                                   .start_bit = 16,
                                   .length_bits = 8,
                                   .max = 255,
                                   .comment = "Counts the frames of this message, 0 to 255."};
inline constexpr const Signal* kFdE2eHeader[] = {&kFdChecksum, &kFdCounter};

constexpr std::span<const Signal* const> e2e_header(FrameFormat format) {
  if (format == FrameFormat::kFd) return kFdE2eHeader;
  return kE2eHeader;
}

/// Bytes of the E2E header, and of the content after it.
constexpr size_t header_length(FrameFormat format) {
  return format == FrameFormat::kFd ? 3 : 2;
}
constexpr size_t content_length(const Message& message) {
  return message.length - header_length(message.format);
}

/// Returns a frame in which every signal is SNA, or 0 if the signal has no SNA value.
Frame blank_frame(const Message& message, const BaseIds& base);

}  // namespace bevloc::can
