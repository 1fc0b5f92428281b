#include "can/bus/bus_condition.h"

#include <string_view>
#include <utility>

namespace bevloc::can {
namespace {

std::string_view name_of(BusState state) {
  switch (state) {
    case BusState::kActive:
      return "ok";
    case BusState::kWarning:
      return "error-warning";
    case BusState::kPassive:
      return "error-passive";
    case BusState::kOff:
      return "bus-off";
    case BusState::kDown:
      return "down";
  }
  return "unknown";
}

constexpr std::pair<BusFault, std::string_view> kFaultNames[] = {
    {BusFault::kNoAcknowledge, "no acknowledgement"},
    {BusFault::kTransmitTimeout, "transmit timeout"},
    {BusFault::kTransceiver, "transceiver fault"},
    {BusFault::kNoFd, "interface without CAN FD"},
};

}  // namespace

std::string to_string(const BusCondition& condition) {
  std::string text(name_of(condition.state));
  std::string_view separator = " (";
  for (const auto& [fault, name] : kFaultNames) {
    if (!condition.has(fault)) continue;
    text.append(separator).append(name);
    separator = ", ";
  }
  if (condition.faults != 0) text += ')';
  return text;
}

}  // namespace bevloc::can
