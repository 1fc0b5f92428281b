// What every implementation of Bus must do, mock and real alike.
#include <cerrno>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>
#include <sys/socket.h>

#include "can/bus.h"
#include "can/mock_bus.h"
#include "can/socketcan_bus.h"

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Two endpoints on one bus, and whatever must live as long as they do.
struct Pair {
  std::unique_ptr<Bus> a;
  std::unique_ptr<Bus> b;
};

struct Implementation {
  std::string name;
  /// A pair, or an empty one where this machine cannot have it.
  std::function<Pair()> connect;
};

Pair connect_mock() {
  MockWire wire;
  return {wire.connect(), wire.connect()};
}

/// The SocketCAN code on a socket pair, for machines whose kernel has no CAN.
Pair connect_socket_pair() {
  int descriptors[2];
  if (socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, descriptors) != 0)
    return {};
  return {SocketCanBus::from_descriptor(descriptors[0]),
          SocketCanBus::from_descriptor(descriptors[1])};
}

/// A CAN interface of this machine: BEVLOC_TEST_CAN, or vcan0.
Pair connect_kernel() {
  const char* chosen = std::getenv("BEVLOC_TEST_CAN");
  const std::string interface = chosen != nullptr ? chosen : "vcan0";
  auto a = SocketCanBus::open(interface);
  auto b = SocketCanBus::open(interface);
  if (!a || !b) return {};
  return {std::move(*a), std::move(*b)};
}

class BusConformance : public testing::TestWithParam<Implementation> {
 protected:
  void SetUp() override {
    pair_ = GetParam().connect();
    if (!pair_.a) GTEST_SKIP() << GetParam().name << ": not on this machine";
  }

  Bus& a() { return *pair_.a; }
  Bus& b() { return *pair_.b; }

  static Frame frame(uint32_t id, uint8_t length) {
    Frame made{.id = id, .length = length};
    for (uint8_t i = 0; i < length; ++i) made.data[i] = static_cast<uint8_t>(0xA0 + i);
    return made;
  }

 private:
  Pair pair_;
};

TEST_P(BusConformance, CarriesEveryLengthUnchangedInBothDirections) {
  for (uint8_t length = 0; length <= kMaxFrameLength; ++length) {
    for (const auto& [from, to] : {std::pair(&a(), &b()), std::pair(&b(), &a())}) {
      ASSERT_EQ(from->send(frame(0x123, length), Time{}), SendResult::kSent);
      ASSERT_TRUE(to->wait(seconds(10)));
      const auto received = to->receive();
      ASSERT_TRUE(received);
      EXPECT_EQ(received->frame, frame(0x123, length));
    }
  }
}

TEST_P(BusConformance, CarriesTheSmallestAndTheLargestId) {
  for (const uint32_t id : {0u, kMaxStandardId}) {
    ASSERT_EQ(a().send(frame(id, 2), Time{}), SendResult::kSent);
    ASSERT_TRUE(b().wait(seconds(10)));
    EXPECT_EQ(b().receive()->frame.id, id);
  }
}

TEST_P(BusConformance, KeepsTheOrder) {
  for (uint32_t id = 8; id > 0; --id) {
    ASSERT_EQ(a().send(frame(id, 1), Time{}), SendResult::kSent);
  }
  for (uint32_t id = 8; id > 0; --id) {
    ASSERT_TRUE(b().wait(seconds(10)));
    EXPECT_EQ(b().receive()->frame.id, id);
  }
  EXPECT_FALSE(b().receive());
}

TEST_P(BusConformance, DoesNotHearItself) {
  ASSERT_EQ(a().send(frame(1, 1), Time{}), SendResult::kSent);
  ASSERT_TRUE(b().wait(seconds(10)));
  EXPECT_FALSE(a().receive());
}

TEST_P(BusConformance, AnEmptyBusGivesNothingAndDoesNotBlock) {
  EXPECT_FALSE(a().receive());
  EXPECT_FALSE(a().wait(milliseconds(0)));
  EXPECT_FALSE(a().wait(milliseconds(1)));
}

TEST_P(BusConformance, WaitEndsWhenAFrameComes) {
  bool came = false;
  std::thread reader([&] { came = b().wait(seconds(30)); });
  ASSERT_EQ(a().send(frame(1, 1), Time{}), SendResult::kSent);
  reader.join();
  EXPECT_TRUE(came);
  EXPECT_TRUE(b().receive());
}

TEST_P(BusConformance, TimeOfArrivalNeverGoesBack) {
  Time last{};
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(a().send(frame(1, 1), Time(seconds(i))), SendResult::kSent);
    ASSERT_TRUE(b().wait(seconds(10)));
    const Time received = b().receive()->received;
    EXPECT_GE(received, last);
    last = received;
  }
}

TEST_P(BusConformance, CountsWhatItDoes) {
  ASSERT_EQ(a().send(frame(1, 1), Time{}), SendResult::kSent);
  ASSERT_EQ(a().send(frame(2, 1), Time{}), SendResult::kSent);
  ASSERT_TRUE(b().wait(seconds(10)));
  EXPECT_TRUE(b().receive());
  EXPECT_EQ(a().counters().sent, 2u);
  EXPECT_EQ(a().counters().received, 0u);
  EXPECT_EQ(b().counters().sent, 0u);
  EXPECT_EQ(b().counters().received, 1u);
}

TEST_P(BusConformance, AFloodNeverBlocksAndEveryFrameIsAccountedFor) {
  constexpr uint32_t kFrames = 5000;
  for (uint32_t i = 0; i < kFrames; ++i) a().send(frame(i % 7, 8), Time{});
  uint64_t arrived = 0;
  while (b().receive()) ++arrived;
  // The kernel tells of lost frames with the next one that arrives.
  ASSERT_EQ(a().send(frame(9, 8), Time{}), SendResult::kSent);
  ASSERT_TRUE(b().wait(seconds(10)));
  while (b().receive()) ++arrived;

  const BusCounters sender = a().counters();
  const BusCounters receiver = b().counters();
  EXPECT_EQ(sender.sent + sender.send_dropped, kFrames + 1);
  EXPECT_EQ(receiver.received, arrived);
  EXPECT_EQ(receiver.received + receiver.receive_dropped, sender.sent);
  EXPECT_GT(arrived, 1u);
}

INSTANTIATE_TEST_SUITE_P(Buses, BusConformance,
                         testing::Values(Implementation{"Mock", connect_mock},
                                         Implementation{"SocketCanOnSocketPair",
                                                        connect_socket_pair},
                                         Implementation{"SocketCan", connect_kernel}),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace bevloc::can
