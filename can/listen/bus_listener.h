// Decodes every frame of a bus by DBC files, and checks the protection of bevloc's own messages.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "can/bus/frame.h"
#include "can/dbc/dbc.h"
#include "can/e2e/e2e.h"
#include "can/messages/message.h"

namespace bevloc::can {

/// The value of one signal in one frame.
struct DecodedSignal {
  const DbcSignal* signal = nullptr;
  double value = 0.0;
  int64_t raw = 0;                ///< the result of raw_from()
  bool is_available = true;       ///< whether the value is one of DbcSignal::available_values()
  std::string_view value_name{};  ///< the name that VAL_ gives; empty if it gives none
};

/// One frame of a message that a DBC file describes.
struct DecodedFrame {
  const DbcMessage* message = nullptr;
  std::optional<E2eResult> e2e{};  ///< the check of bevloc's own messages
  bool is_short = false;  ///< the frame is shorter than the message; only what fits is decoded
  std::vector<DecodedSignal> signals{};
};

/// One thread.
class BusListener {
 public:
  struct Total {
    uint64_t frames = 0;
    uint64_t unusable = 0;  ///< bevloc's own frames that are repeated or have a wrong CRC or length
    uint64_t lost = 0;      ///< bevloc's own frames that are missing before a usable one
  };

  /// Decodes the messages of `files`, and bevloc's own messages with these base ids, which must be
  /// apart. A message of a file replaces bevloc's message with the same identifier. Messages that a
  /// file leaves out are unknown.
  BusListener(std::vector<Dbc> files, const BaseIds& base);

  /// Decodes a frame. Returns null if no file describes its message. The result is valid until the
  /// next call. Each interface of a log is a bus of its own: its frames are checked apart from
  /// those of the others.
  const DecodedFrame* decode(const Frame& frame, std::string_view interface = "");

  /// The totals of all interfaces by name of the message.
  const std::map<std::string, Total>& totals() const { return totals_; }
  uint64_t unknown() const { return unknown_; }
  /// Whether some file has a message of this name and does not leave it out.
  bool knows(std::string_view message) const;

 private:
  struct Known {
    const DbcMessage* message = nullptr;       ///< a message that may be left out
    std::vector<AvailableValues> available{};  ///< the available values of each signal
    const Message* own = nullptr;              ///< null if it is not one of bevloc's messages
    std::map<std::string, E2eChecker, std::less<>> checkers{};  ///< by interface
  };

  E2eResult check(const Frame& frame, std::string_view interface, Known& known);
  void add_signals(const Known& known, std::span<const uint8_t> bytes);

  std::vector<Dbc> files_;
  std::map<uint32_t, Known> known_;  ///< the messages by identifier
  std::map<std::string, Total> totals_;
  uint64_t unknown_ = 0;
  DecodedFrame decoded_;
};

std::string_view name_of(E2eResult result);

/// Returns a line such as "0.520000 LOC_PosLocal ok LocalEast=1.23m LocalNorth=-4.50m". A value
/// that is not available has the name SNA, or "(not_available)" follows it.
std::string text_of(const DecodedFrame& frame, double time_s);
/// Returns one line of JSON with time_s, id, message, e2e and signals. The value of a signal that
/// is not available is null. The value of a signal without scale and offset is a whole number.
std::string json_of(const DecodedFrame& frame, double time_s);

}  // namespace bevloc::can
