// The condition of a CAN bus, as its controller and the kernel report it.
#pragma once

#include <cstdint>
#include <string>

namespace bevloc::can {

/// The fault confinement states of ISO 11898-1, and kDown for the interface itself.
enum class BusState : uint8_t {
  kActive,   ///< no problem
  kWarning,  ///< an error counter has reached 96
  kPassive,  ///< an error counter has reached 128: the controller may no longer signal errors
  kOff,      ///< the controller has left the bus and waits for its restart
  kDown,     ///< the interface is down or gone
};

/// A cause that the controller or the kernel reports. A fault can be set in every state.
enum class BusFault : uint8_t {
  kNoAcknowledge = 1u << 0,    ///< no other node on the bus, or the bit rates differ
  kTransmitTimeout = 1u << 1,  ///< the driver gave up sending a frame
  kTransceiver = 1u << 2,      ///< a wire is broken or shorted
  kNoFd = 1u << 3,             ///< CAN FD is needed and the interface is not set up for it
};

struct BusCondition {
  BusState state = BusState::kActive;
  uint8_t faults = 0;  ///< a set of BusFault bits

  constexpr bool has(BusFault fault) const { return (faults & static_cast<uint8_t>(fault)) != 0; }
  constexpr void add(BusFault fault) {
    faults = static_cast<uint8_t>(faults | static_cast<uint8_t>(fault));
  }
  bool operator==(const BusCondition&) const = default;
};

/// Returns a text such as "error-passive (no acknowledgement)".
std::string to_string(const BusCondition& condition);

}  // namespace bevloc::can
