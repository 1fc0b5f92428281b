#include "can/bus/controller_monitor.h"

#include <linux/can/error.h>

namespace bevloc::can {
namespace {

/// Returns the state in a report of class CAN_ERR_CRTL, or `before` if the report names no state.
BusState state_from(uint8_t controller_status, BusState before) {
  if ((controller_status & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
    return BusState::kPassive;
  }
  if ((controller_status & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
    return BusState::kWarning;
  }
  return (controller_status & CAN_ERR_CRTL_ACTIVE) != 0 ? BusState::kActive : before;
}

}  // namespace

bool says_frames_lost(const ErrorFrame& error) {
  return (error.classes & CAN_ERR_CRTL) != 0 && (error.data[1] & CAN_ERR_CRTL_RX_OVERFLOW) != 0;
}

void ControllerMonitor::take(const ErrorFrame& error) {
  BusCondition condition = condition_;
  if ((error.classes & CAN_ERR_RESTARTED) != 0) condition = BusCondition{};
  if ((error.classes & CAN_ERR_CRTL) != 0) {
    condition.state = state_from(error.data[1], condition.state);
  }
  if ((error.classes & CAN_ERR_BUSOFF) != 0) condition.state = BusState::kOff;
  if ((error.classes & CAN_ERR_ACK) != 0) condition.add(BusFault::kNoAcknowledge);
  if ((error.classes & CAN_ERR_TX_TIMEOUT) != 0) condition.add(BusFault::kTransmitTimeout);
  if ((error.classes & CAN_ERR_TRX) != 0) condition.add(BusFault::kTransceiver);
  condition_ = condition;
}

bool ControllerMonitor::note_traffic() {
  BusCondition condition = condition_;
  const bool was_off = condition.state == BusState::kOff;
  condition.faults = 0;
  if (was_off) condition.state = BusState::kActive;
  condition_ = condition;
  return was_off;
}

}  // namespace bevloc::can
