#include "can/bus/mock_bus.h"

#include <gtest/gtest.h>

#include "can/bus/receive_queue.h"

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;

ReceivedFrame received(uint32_t id, uint8_t content) {
  ReceivedFrame frame{.frame = {.id = id, .length = 1}};
  frame.frame.data[0] = content;
  return frame;
}

TEST(ReceiveQueue, WhenFullANewFrameReplacesTheOldestOfItsId) {
  ReceiveQueue queue(3);
  EXPECT_TRUE(queue.push(received(1, 10)));
  EXPECT_TRUE(queue.push(received(2, 20)));
  EXPECT_TRUE(queue.push(received(3, 30)));
  EXPECT_FALSE(queue.push(received(2, 21)));
  EXPECT_EQ(queue.pop()->frame, received(1, 10).frame);
  EXPECT_EQ(queue.pop()->frame, received(3, 30).frame);
  EXPECT_EQ(queue.pop()->frame, received(2, 21).frame);
  EXPECT_FALSE(queue.pop());
}

TEST(ReceiveQueue, WhenFullANewIdReplacesTheOldestFrame) {
  ReceiveQueue queue(2);
  queue.push(received(1, 10));
  queue.push(received(2, 20));
  EXPECT_FALSE(queue.push(received(3, 30)));
  EXPECT_EQ(queue.pop()->frame.id, 2u);
  EXPECT_EQ(queue.pop()->frame.id, 3u);
}

TEST(ReceiveQueue, KeepsTheOrder) {
  ReceiveQueue queue(3);
  for (uint8_t i = 0; i < 20; ++i) {
    queue.push(received(i, i));
    queue.push(received(i + 100u, i));
    EXPECT_EQ(queue.pop()->frame.id, i);
    EXPECT_EQ(queue.pop()->frame.id, i + 100u);
  }
  EXPECT_TRUE(queue.empty());
}

TEST(MockWire, EveryOtherEndpointSeesAFrameAtTheSendersTime) {
  MockWire wire;
  const auto a = wire.connect();
  const auto b = wire.connect();
  const auto c = wire.connect();
  const Time now(milliseconds(1234));
  a->send({.id = 7, .length = 1}, now);
  for (Bus* other : {b.get(), c.get()}) {
    const auto frame = other->receive();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->received, now);
  }
  EXPECT_FALSE(a->receive());
}

TEST(MockWire, CountsFramesThatAReaderDidNotFetch) {
  MockWire wire(2);
  const auto a = wire.connect();
  const auto b = wire.connect();
  for (uint8_t i = 0; i < 5; ++i) a->send({.id = 7, .length = 1, .data = {i}}, Time{});
  EXPECT_EQ(b->counters().receive_dropped, 3u);
  EXPECT_EQ(b->receive()->frame.data[0], 3);
  EXPECT_EQ(b->receive()->frame.data[0], 4);
}

TEST(MockWire, AWireThatIsDownAcceptsNoFrame) {
  MockWire wire;
  const auto a = wire.connect();
  const auto b = wire.connect();
  wire.set_down(true);
  EXPECT_EQ(a->send({.id = 1}, Time{}), SendResult::kBusDown);
  EXPECT_FALSE(b->receive());
  EXPECT_EQ(a->counters().send_bus_down, 1u);
  wire.set_down(false);
  EXPECT_EQ(a->send({.id = 1}, Time{}), SendResult::kSent);
}

TEST(MockWire, EndpointsComeAndGo) {
  MockWire wire;
  const auto a = wire.connect();
  auto b = wire.connect();
  b.reset();
  EXPECT_EQ(a->send({.id = 1}, Time{}), SendResult::kSent);
  const auto late = wire.connect();
  EXPECT_FALSE(late->receive());
}

}  // namespace
}  // namespace bevloc::can
