#include "can/socketcan_bus.h"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <sys/socket.h>
#include <unistd.h>

namespace bevloc::can {
namespace {

/// The bus on one end of a socket pair, and the other end to put anything into it.
class SocketCanWire : public testing::Test {
 protected:
  SocketCanWire() {
    int descriptors[2];
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0, descriptors), 0);
    bus_ = SocketCanBus::from_descriptor(descriptors[0]);
    far_end_ = descriptors[1];
  }
  ~SocketCanWire() override { close(far_end_); }

  template <typename T>
  void put(const T& raw) {
    ASSERT_EQ(::send(far_end_, &raw, sizeof(raw), 0), static_cast<ssize_t>(sizeof(raw)));
  }

  std::unique_ptr<SocketCanBus> bus_;
  int far_end_ = -1;
};

can_frame data_frame(canid_t id, uint8_t length) {
  can_frame raw{};
  raw.can_id = id;
  raw.can_dlc = length;
  return raw;
}

TEST_F(SocketCanWire, WritesTheKernelsFrame) {
  bus_->send({.id = 0x512, .length = 3, .data = {1, 2, 3}}, Time{});
  can_frame raw{};
  ASSERT_EQ(::recv(far_end_, &raw, sizeof(raw), MSG_DONTWAIT), CAN_MTU);
  EXPECT_EQ(raw.can_id, 0x512u);
  EXPECT_EQ(raw.can_dlc, 3);
  EXPECT_EQ(raw.data[2], 3);
}

TEST_F(SocketCanWire, SkipsAndCountsWhatIsNoStandardDataFrame) {
  put(data_frame(0x123 | CAN_EFF_FLAG, 8));
  put(data_frame(0x123 | CAN_RTR_FLAG, 0));
  put(data_frame(0x123, 9));
  canfd_frame fd{};
  fd.can_id = 0x123;
  fd.len = 64;
  put(fd);
  put(uint32_t{0x123});
  put(data_frame(0x321, 8));
  const auto received = bus_->receive();
  ASSERT_TRUE(received);
  EXPECT_EQ(received->frame.id, 0x321u);
  EXPECT_EQ(bus_->counters().receive_ignored, 5u);
  EXPECT_EQ(bus_->counters().received, 1u);
}

TEST_F(SocketCanWire, CountsErrorFramesAndBusOff) {
  put(data_frame(CAN_ERR_FLAG | CAN_ERR_ACK, CAN_ERR_DLC));
  put(data_frame(CAN_ERR_FLAG | CAN_ERR_BUSOFF, CAN_ERR_DLC));
  EXPECT_FALSE(bus_->receive());
  EXPECT_EQ(bus_->counters().error_frames, 2u);
  EXPECT_EQ(bus_->counters().bus_off, 1u);
}

TEST_F(SocketCanWire, AFullQueueDropsAndCounts) {
  SendResult result = SendResult::kSent;
  for (int i = 0; i < 100000 && result == SendResult::kSent; ++i) {
    result = bus_->send({.id = 1, .length = 8}, Time{});
  }
  EXPECT_EQ(result, SendResult::kDropped);
  EXPECT_EQ(bus_->counters().send_dropped, 1u);
}

TEST_F(SocketCanWire, ABusThatIsGoneIsDown) {
  ASSERT_EQ(shutdown(far_end_, SHUT_RDWR), 0);
  EXPECT_EQ(bus_->send({.id = 1}, Time{}), SendResult::kBusDown);
  EXPECT_EQ(bus_->counters().send_bus_down, 1u);
}

TEST(SocketCanBus, AnAbsentInterfaceIsAnError) {
  const auto bus = SocketCanBus::open("bevlocnone0");
  ASSERT_FALSE(bus);
  EXPECT_THAT(bus.error().message, testing::HasSubstr("bevlocnone0"));
  EXPECT_THAT(bus.error().message, testing::HasSubstr("wanted"));
}

TEST(SocketCanBus, FiltersInTheKernel) {
  const char* chosen = std::getenv("BEVLOC_TEST_CAN");
  const std::string interface = chosen != nullptr ? chosen : "vcan0";
  auto sender = SocketCanBus::open(interface);
  auto reader = SocketCanBus::open(interface, {0x401, 0x403});
  if (!sender || !reader) GTEST_SKIP() << "SocketCan: not on this machine";
  for (uint32_t id = 0x400; id < 0x405; ++id) (*sender)->send({.id = id}, Time{});
  for (const uint32_t id : {0x401u, 0x403u}) {
    ASSERT_TRUE((*reader)->wait(std::chrono::seconds(10)));
    EXPECT_EQ((*reader)->receive()->frame.id, id);
  }
  EXPECT_FALSE((*reader)->receive());
}

}  // namespace
}  // namespace bevloc::can
