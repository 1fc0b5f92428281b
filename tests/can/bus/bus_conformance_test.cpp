// The conformance suite of Bus: every implementation must pass it, mock or real.
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "can/bus/bus.h"
#include "tests/can/bus/bus_under_test.h"
#include "tests/support/open_descriptors.h"

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::open_descriptors;

class BusConformance : public testing::TestWithParam<BusImplementation> {
 protected:
  void SetUp() override {
    pair_ = GetParam().connect();
    if (!pair_.refusal.empty()) FAIL() << pair_.refusal;
    if (!pair_.a) GTEST_SKIP() << GetParam().name << ": not available on this machine";
  }

  Bus& a() { return *pair_.a; }
  Bus& b() { return *pair_.b; }
  BusPair& pair() { return pair_; }

  static Frame frame(uint32_t id, size_t length, FrameFormat format = FrameFormat::kClassic) {
    Frame made{.id = id, .length = static_cast<uint8_t>(length), .data = {}, .format = format};
    for (size_t i = 0; i < length; ++i) made.data[i] = static_cast<uint8_t>(0xA0 + i);
    return made;
  }

  /// Sends a frame and expects that the other endpoint receives it unchanged.
  static void expect_carried(Bus& from, Bus& to, const Frame& sent) {
    ASSERT_EQ(from.send(sent, Time{}), SendResult::kSent);
    ASSERT_TRUE(to.wait(seconds(10)));
    const auto received = to.receive();
    ASSERT_TRUE(received);
    EXPECT_EQ(received->frame, sent);
  }

  /// Repeats the call until there is room, because a real bus needs time for each frame.
  static void send_patiently(Bus& bus, const Frame& sent) {
    for (int attempt = 0; attempt < 1000; ++attempt) {
      if (bus.send(sent, Time{}) == SendResult::kSent) return;
      bus.wait(milliseconds(1));
    }
    ADD_FAILURE() << "no room on the bus";
  }

 private:
  BusPair pair_;
};

TEST_P(BusConformance, CarriesEveryLengthUnchangedInBothDirections) {
  for (uint8_t length = 0; length <= kMaxClassicLength; ++length) {
    expect_carried(a(), b(), frame(0x123, length));
    expect_carried(b(), a(), frame(0x123, length));
  }
}

TEST_P(BusConformance, CarriesEveryLengthOfFdUnchanged) {
  if (!pair().carries_fd) GTEST_SKIP() << GetParam().name << ": a classic interface";
  for (size_t length = 0; length <= kMaxFdLength; ++length) {
    if (!is_valid_length(FrameFormat::kFd, length)) continue;
    expect_carried(a(), b(), frame(0x123, length, FrameFormat::kFd));
  }
}

TEST_P(BusConformance, CarriesTheSmallestAndTheLargestId) {
  for (const uint32_t id : {0u, kMaxStandardId}) expect_carried(a(), b(), frame(id, 2));
}

TEST_P(BusConformance, CarriesAnyNumberOfFramesInTheirOrder) {
  for (const uint32_t count : {1u, 2u, 3u, 5u, 8u, 89u}) {
    for (uint32_t id = count; id > 0; --id) send_patiently(a(), frame(id, 1));
    for (uint32_t id = count; id > 0; --id) {
      ASSERT_TRUE(b().wait(seconds(10)));
      EXPECT_EQ(b().receive()->frame.id, id);
    }
    EXPECT_FALSE(b().receive());
  }
}

TEST_P(BusConformance, DoesNotReceiveItsOwnFrames) {
  ASSERT_EQ(a().send(frame(1, 1), Time{}), SendResult::kSent);
  ASSERT_TRUE(b().wait(seconds(10)));
  EXPECT_FALSE(a().receive());
}

TEST_P(BusConformance, AnEmptyBusReturnsNothingAndDoesNotBlock) {
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
  // The kernel reports lost frames together with the next frame that arrives.
  send_patiently(a(), frame(9, 8));
  ASSERT_TRUE(b().wait(seconds(10)));
  while (b().receive()) ++arrived;

  const BusCounters sender = a().counters();
  const BusCounters receiver = b().counters();
  EXPECT_EQ(sender.sent + sender.send_replaced + sender.send_waiting + sender.send_expired,
            kFrames + 1);
  EXPECT_EQ(receiver.received, arrived);
  EXPECT_EQ(receiver.received + receiver.receive_dropped, sender.sent);
  EXPECT_GT(arrived, 1u);
}

TEST_P(BusConformance, StartsRepeatedlyAndLeaksNoDescriptor) {
  pair() = {};
  const int before = open_descriptors();
  for (int start = 0; start < 3; ++start) {
    pair() = GetParam().connect();
    ASSERT_TRUE(pair().a);
    expect_carried(a(), b(), frame(0x321, 4));
    pair() = {};
    EXPECT_EQ(open_descriptors(), before);
  }
}

TEST_P(BusConformance, StopsWithFramesUnread) {
  const int before = open_descriptors();
  BusPair other = GetParam().connect();
  ASSERT_TRUE(other.a);
  for (uint32_t id = 0; id < 5; ++id) other.a->send(frame(id, 8), Time{});
  other = {};
  EXPECT_EQ(open_descriptors(), before);
}

TEST_P(BusConformance, ReportsThatItIsDownAndSendsAgainWhenItIsUp) {
  if (!pair().set_up) GTEST_SKIP() << GetParam().name << ": cannot be down";
  if (!pair().set_up(false)) GTEST_SKIP() << GetParam().name << ": needs CAP_NET_ADMIN";
  EXPECT_EQ(a().send(frame(1, 1), Time{}), SendResult::kBusDown);
  EXPECT_EQ(a().condition().state, BusState::kDown);
  EXPECT_EQ(a().counters().send_bus_down, 1u);
  EXPECT_FALSE(b().receive());

  ASSERT_TRUE(pair().set_up(true));
  send_patiently(a(), frame(2, 1));
  EXPECT_EQ(a().condition().state, BusState::kActive);
  ASSERT_TRUE(b().wait(seconds(10)));
  EXPECT_EQ(b().receive()->frame.id, 2u) << "a frame sent while the bus was down arrived later";
}

INSTANTIATE_TEST_SUITE_P(Buses, BusConformance, testing::ValuesIn(buses_under_test()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace bevloc::can
