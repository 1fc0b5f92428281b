#include "can/bus/send_queue.h"

#include <vector>

#include <gtest/gtest.h>

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;
using Answer = SendQueue::Answer;

Frame frame(uint32_t id, uint8_t content) {
  return {.id = id, .length = 1, .data = {content}};
}

std::vector<uint8_t> take_all(SendQueue& queue) {
  std::vector<uint8_t> contents;
  queue.offer([&](const Frame& next) {
    contents.push_back(next.data[0]);
    return Answer::kTaken;
  });
  return contents;
}

TEST(SendQueue, ANewerFrameTakesThePlaceOfTheOldOne) {
  SendQueue queue(4);
  EXPECT_TRUE(queue.push(frame(1, 10), Time{}));
  EXPECT_TRUE(queue.push(frame(2, 20), Time{}));
  EXPECT_FALSE(queue.push(frame(1, 11), Time{}));
  EXPECT_EQ(queue.size(), 2u);
  EXPECT_EQ(take_all(queue), (std::vector<uint8_t>{11, 20}));
  EXPECT_EQ(queue.size(), 0u);
}

TEST(SendQueue, WhenFullTheOldestIsDropped) {
  SendQueue queue(2);
  queue.push(frame(1, 10), Time(milliseconds(1)));
  queue.push(frame(2, 20), Time(milliseconds(2)));
  queue.push(frame(1, 11), Time(milliseconds(3)));
  EXPECT_FALSE(queue.push(frame(3, 30), Time(milliseconds(4))));
  EXPECT_EQ(take_all(queue), (std::vector<uint8_t>{11, 30}));
}

TEST(SendQueue, TheAgeCountsFromTheLastPush) {
  SendQueue queue(4);
  queue.push(frame(1, 10), Time(milliseconds(1)));
  queue.push(frame(2, 20), Time(milliseconds(2)));
  queue.push(frame(1, 11), Time(milliseconds(9)));
  EXPECT_EQ(queue.drop_older_than(Time(milliseconds(2))), 0u);
  EXPECT_EQ(queue.drop_older_than(Time(milliseconds(5))), 1u);
  EXPECT_TRUE(queue.holds(1));
  EXPECT_FALSE(queue.holds(2));
}

TEST(SendQueue, FramesThatWereNotTakenKeepTheirOrder) {
  SendQueue queue(4);
  for (uint8_t id = 1; id <= 4; ++id) queue.push(frame(id, id), Time{});
  queue.offer([](const Frame& next) {
    if (next.id == 1) return Answer::kLater;
    return next.id == 2 ? Answer::kTaken : Answer::kNoRoom;
  });
  EXPECT_EQ(take_all(queue), (std::vector<uint8_t>{1, 3, 4}));
}

TEST(SendQueue, AfterNoRoomNothingElseIsOffered) {
  SendQueue queue(4);
  for (uint8_t id = 1; id <= 4; ++id) queue.push(frame(id, id), Time{});
  int offered = 0;
  queue.offer([&](const Frame&) {
    ++offered;
    return Answer::kNoRoom;
  });
  EXPECT_EQ(offered, 1);
  EXPECT_EQ(queue.size(), 4u);
}

}  // namespace
}  // namespace bevloc::can
