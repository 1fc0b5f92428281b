#include "can/bus/controller_monitor.h"

#include <gtest/gtest.h>
#include <linux/can/error.h>

namespace bevloc::can {
namespace {

ErrorFrame report(uint32_t classes, uint8_t controller_status = 0) {
  return {.classes = classes, .data = {0, controller_status}};
}

TEST(ControllerMonitor, FollowsTheStatesOfFaultConfinement) {
  ControllerMonitor monitor;
  EXPECT_EQ(to_string(monitor.condition()), "ok");
  monitor.take(report(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING));
  EXPECT_EQ(to_string(monitor.condition()), "error-warning");
  monitor.take(report(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING | CAN_ERR_CRTL_RX_PASSIVE));
  EXPECT_EQ(to_string(monitor.condition()), "error-passive");
  monitor.take(report(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE));
  EXPECT_EQ(to_string(monitor.condition()), "ok");
  monitor.take(report(CAN_ERR_CRTL | CAN_ERR_BUSOFF, CAN_ERR_CRTL_TX_PASSIVE));
  EXPECT_EQ(to_string(monitor.condition()), "bus-off");
  monitor.take(report(CAN_ERR_RESTARTED));
  EXPECT_EQ(to_string(monitor.condition()), "ok");
}

TEST(ControllerMonitor, AnOverflowDoesNotChangeTheState) {
  ControllerMonitor monitor;
  monitor.take(report(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_PASSIVE));
  monitor.take(report(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW));
  EXPECT_EQ(monitor.condition().state, BusState::kPassive);
}

TEST(ControllerMonitor, FindsReportsOfLostFrames) {
  EXPECT_TRUE(says_frames_lost(report(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW)));
  EXPECT_TRUE(
      says_frames_lost(report(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_RX_WARNING)));
  EXPECT_FALSE(says_frames_lost(report(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_OVERFLOW)));
  EXPECT_FALSE(says_frames_lost(report(CAN_ERR_ACK, CAN_ERR_CRTL_RX_OVERFLOW)))
      << "the byte belongs to the class CAN_ERR_CRTL";
}

TEST(ControllerMonitor, NamesEveryFault) {
  ControllerMonitor monitor;
  monitor.take(report(CAN_ERR_ACK));
  monitor.take(report(CAN_ERR_TX_TIMEOUT));
  monitor.take(report(CAN_ERR_TRX));
  EXPECT_TRUE(monitor.condition().has(BusFault::kNoAcknowledge));
  EXPECT_EQ(to_string(monitor.condition()),
            "ok (no acknowledgement, transmit timeout, transceiver fault)");
}

TEST(ControllerMonitor, TrafficClearsFaultsAndBusOffButNotErrorPassive) {
  ControllerMonitor monitor;
  monitor.take(report(CAN_ERR_CRTL | CAN_ERR_ACK, CAN_ERR_CRTL_TX_PASSIVE));
  EXPECT_FALSE(monitor.note_traffic());
  EXPECT_EQ(to_string(monitor.condition()), "error-passive");
  monitor.take(report(CAN_ERR_BUSOFF));
  EXPECT_TRUE(monitor.note_traffic()) << "a restart without a report";
  EXPECT_EQ(monitor.condition(), BusCondition{});
}

TEST(ControllerMonitor, BusOffAtTheStartEndsWithTrafficOrARestart) {
  for (const bool by_traffic : {true, false}) {
    ControllerMonitor monitor;
    monitor.note_bus_off();
    EXPECT_EQ(to_string(monitor.condition()), "bus-off");
    if (by_traffic) {
      monitor.note_traffic();
    } else {
      monitor.take(report(CAN_ERR_RESTARTED));
    }
    EXPECT_EQ(monitor.condition(), BusCondition{});
  }
}

TEST(ControllerMonitor, AResetClearsTheCondition) {
  ControllerMonitor monitor;
  monitor.take(report(CAN_ERR_BUSOFF | CAN_ERR_ACK));
  monitor.reset();
  EXPECT_EQ(monitor.condition(), BusCondition{});
}

}  // namespace
}  // namespace bevloc::can
