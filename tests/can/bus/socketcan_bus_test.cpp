#include "can/bus/socketcan_bus.h"

#include <array>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/sock_diag.h>
#include <sys/socket.h>
#include <unistd.h>

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;

/// A bus on one end of a socket pair. The test writes any bytes into the other end.
class SocketCanWire : public testing::Test {
 protected:
  explicit SocketCanWire(const SocketCanOptions& options = {}) {
    int descriptors[2];
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0, descriptors), 0);
    bus_ = SocketCanBus::from_descriptor(descriptors[0], options);
    far_end_ = descriptors[1];
  }
  ~SocketCanWire() override { close(far_end_); }

  template <typename T>
  void put(const T& raw) {
    ASSERT_EQ(::send(far_end_, &raw, sizeof(raw), 0), static_cast<ssize_t>(sizeof(raw)));
  }

  /// Reads all frames at the far end.
  std::vector<can_frame> read_far_end() {
    std::vector<can_frame> frames;
    can_frame raw{};
    while (::recv(far_end_, &raw, sizeof(raw), MSG_DONTWAIT) > 0) frames.push_back(raw);
    return frames;
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

TEST_F(SocketCanWire, SkipsAndCountsEverythingButStandardDataFrames) {
  put(data_frame(0x123 | CAN_EFF_FLAG, 8));
  put(data_frame(0x123 | CAN_RTR_FLAG, 0));
  put(data_frame(0x123, 9));
  canfd_frame fd{};
  fd.can_id = 0x123;
  fd.len = 63;
  put(fd);
  put(uint32_t{0x123});
  put(data_frame(0x321, 8));
  const auto received = bus_->receive();
  ASSERT_TRUE(received);
  EXPECT_EQ(received->frame.id, 0x321u);
  EXPECT_EQ(bus_->counters().receive_ignored, 5u);
  EXPECT_EQ(bus_->counters().received, 1u);
}

TEST_F(SocketCanWire, WritesAndReadsTheKernelsFdFrame) {
  Frame frame{.id = 0x509, .length = 64, .data = {1, 2, 3}, .format = FrameFormat::kFd};
  frame.data[63] = 9;
  bus_->send(frame, Time{});
  canfd_frame raw{};
  ASSERT_EQ(::recv(far_end_, &raw, sizeof(raw), MSG_DONTWAIT), CANFD_MTU);
  EXPECT_EQ(raw.can_id, 0x509u);
  EXPECT_EQ(raw.len, 64);
  EXPECT_EQ(raw.flags, CANFD_BRS);
  EXPECT_EQ(raw.data[63], 9);
  put(raw);
  const auto received = bus_->receive();
  ASSERT_TRUE(received);
  EXPECT_EQ(received->frame, frame);
}

TEST_F(SocketCanWire, CountsAndReportsErrorFramesAndBusOff) {
  put(data_frame(CAN_ERR_FLAG | CAN_ERR_ACK, CAN_ERR_DLC));
  put(data_frame(CAN_ERR_FLAG | CAN_ERR_BUSOFF, CAN_ERR_DLC));
  EXPECT_FALSE(bus_->receive());
  EXPECT_EQ(bus_->counters().error_frames, 2u);
  EXPECT_EQ(bus_->counters().bus_off, 1u);
  EXPECT_EQ(to_string(bus_->condition()), "bus-off (no acknowledgement)");
}

TEST_F(SocketCanWire, CountsFramesThatTheControllerLost) {
  can_frame lost = data_frame(CAN_ERR_FLAG | CAN_ERR_CRTL, CAN_ERR_DLC);
  lost.data[1] = CAN_ERR_CRTL_RX_OVERFLOW;
  put(lost);
  put(lost);
  put(data_frame(CAN_ERR_FLAG | CAN_ERR_ACK, CAN_ERR_DLC));
  EXPECT_FALSE(bus_->receive());
  EXPECT_EQ(bus_->counters().receive_overrun, 2u);
  EXPECT_EQ(bus_->condition().state, BusState::kActive);
}

/// A wire that confirms no frame. The frames that the far end has not read wait, as in the queue of
/// the kernel.
class SocketCanGate : public SocketCanWire {
 protected:
  SocketCanGate() : SocketCanWire({.confirmed_ids = {0x500}}) {}

  SendResult send() { return bus_->send({.id = 0x500}, Time{}); }
  void report(canid_t classes) {
    put(data_frame(CAN_ERR_FLAG | classes, CAN_ERR_DLC));
    EXPECT_FALSE(bus_->receive());
  }

  /// Whether the system tells a socket how much of its queue has not been sent (Linux 4.12).
  bool says_what_is_queued() const {
    std::array<uint32_t, SK_MEMINFO_VARS> memory{};
    socklen_t size = sizeof(memory);
    return getsockopt(far_end_, SOL_SOCKET, SO_MEMINFO, memory.data(), &size) == 0;
  }
};

TEST_F(SocketCanGate, ARestartOfTheControllerAddsNoFrameToTheQueue) {
  if (!says_what_is_queued()) GTEST_SKIP() << "there is no SO_MEMINFO, as under qemu-user";
  for (int restart = 0; restart < 3; ++restart) {
    send();
    report(CAN_ERR_BUSOFF);
    EXPECT_EQ(send(), SendResult::kWaiting);
    report(CAN_ERR_RESTARTED);
    EXPECT_EQ(send(), SendResult::kWaiting) << "the first frame has not left the queue";
  }
  EXPECT_EQ(read_far_end().size(), 1u);
  EXPECT_EQ(send(), SendResult::kWaiting) << "the controller may still send it";
  put(data_frame(0x321, 8));
  EXPECT_TRUE(bus_->receive());
  EXPECT_EQ(send(), SendResult::kSent) << "the bus is alive, and the queue is empty";
}

TEST_F(SocketCanGate, ARestartDiscardsTheFramesInTheController) {
  for (const canid_t restarted : {CAN_ERR_RESTARTED, CAN_ERR_TX_TIMEOUT}) {
    send();
    read_far_end();
    report(CAN_ERR_BUSOFF);
    EXPECT_EQ(send(), SendResult::kWaiting);
    report(restarted);
    EXPECT_EQ(send(), SendResult::kSent);
    read_far_end();
    report(CAN_ERR_RESTARTED);
  }
}

TEST(BusCondition, SaysThatTheInterfaceIsAClassicOne) {
  BusCondition condition{.state = BusState::kDown};
  condition.add(BusFault::kNoFd);
  EXPECT_TRUE(condition.has(BusFault::kNoFd));
  EXPECT_EQ(to_string(condition), "down (interface without CAN FD)");
}

/// A socket pair that is filled with frames until there is no room, because the far end reads none.
class FullSocketCanWire : public SocketCanWire {
 protected:
  FullSocketCanWire() {
    SendResult result = SendResult::kSent;
    while (result == SendResult::kSent) result = send(0x7FF, 0, milliseconds(0));
    EXPECT_EQ(result, SendResult::kWaiting);
  }

  SendResult send(uint32_t id, uint8_t content, Duration at) {
    return bus_->send({.id = id, .length = 1, .data = {content}}, Time(at));
  }

  /// Empties the wire and returns its frames, except those that the constructor filled in.
  std::vector<can_frame> drain() {
    std::vector<can_frame> frames = read_far_end();
    std::erase_if(frames, [](const can_frame& raw) { return raw.can_id == 0x7FF; });
    return frames;
  }
};

TEST_F(FullSocketCanWire, KeepsTheNewestOfEachIdUntilThereIsRoom) {
  EXPECT_EQ(send(1, 10, milliseconds(1)), SendResult::kWaiting);
  EXPECT_EQ(send(2, 20, milliseconds(2)), SendResult::kWaiting);
  EXPECT_EQ(send(1, 11, milliseconds(3)), SendResult::kWaiting);
  EXPECT_EQ(bus_->counters().send_waiting, 3u);
  EXPECT_EQ(bus_->counters().send_replaced, 1u);
  EXPECT_TRUE(drain().empty());
  EXPECT_EQ(send(3, 30, milliseconds(4)), SendResult::kSent);
  const auto frames = drain();
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].can_id, 1u);
  EXPECT_EQ(frames[0].data[0], 11) << "the newest";
  EXPECT_EQ(frames[1].can_id, 2u);
  EXPECT_EQ(frames[2].can_id, 3u);
  EXPECT_EQ(bus_->counters().send_waiting, 0u);
}

TEST_F(FullSocketCanWire, NeverSendsAnExpiredFrame) {
  const Duration limit = SocketCanOptions{}.max_send_age;
  EXPECT_EQ(send(1, 10, milliseconds(1)), SendResult::kWaiting);
  EXPECT_EQ(send(2, 20, milliseconds(2)), SendResult::kWaiting);
  drain();
  EXPECT_EQ(send(3, 30, milliseconds(2) + limit), SendResult::kSent);
  const auto frames = drain();
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].can_id, 2u);
  EXPECT_EQ(frames[1].can_id, 3u);
  EXPECT_EQ(bus_->counters().send_expired, 2u) << "frame 1, and one frame of the constructor";
}

TEST_F(FullSocketCanWire, AccountsForEveryFrameWhenTheBusGoesDown) {
  send(1, 10, milliseconds(1));
  const uint64_t sent = bus_->counters().sent;
  ASSERT_EQ(shutdown(far_end_, SHUT_RDWR), 0);
  drain();
  EXPECT_EQ(send(2, 20, milliseconds(2)), SendResult::kBusDown);
  EXPECT_EQ(bus_->counters().send_bus_down, 3u);
  EXPECT_EQ(bus_->counters().send_waiting, 0u);
  EXPECT_EQ(bus_->counters().sent, sent);
  EXPECT_EQ(bus_->condition().state, BusState::kDown);
}

TEST_F(SocketCanWire, ABusThatDisappearedIsDown) {
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

}  // namespace
}  // namespace bevloc::can
