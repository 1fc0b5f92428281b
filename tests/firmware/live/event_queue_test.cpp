// Tests how viewers of the live page get events.
#include "firmware/live/event_queue.h"

#include <gtest/gtest.h>

namespace bevloc::firmware {
namespace {

/// The next event as text; empty without one.
std::string event_after(EventQueue& queue, uint64_t& next) {
  const auto event = queue.wait_for(next, Duration::zero());
  return event ? *event : "";
}

TEST(EventQueue, EachViewerReadsEveryEventFromItsStartOn) {
  EventQueue queue;
  uint64_t early = queue.end();
  queue.push("a");
  uint64_t late = queue.end();
  queue.push("b");
  EXPECT_EQ(event_after(queue, early), "a");
  EXPECT_EQ(event_after(queue, early), "b");
  EXPECT_EQ(event_after(queue, early), "");
  EXPECT_EQ(event_after(queue, late), "b");
}

TEST(EventQueue, AViewerWhoLagsContinuesWithTheNewest) {
  EventQueue queue;
  uint64_t next = queue.end();
  for (size_t i = 0; i <= EventQueue::kKept; ++i) queue.push(std::to_string(i));
  EXPECT_EQ(event_after(queue, next), std::to_string(EventQueue::kKept));
  EXPECT_EQ(next, EventQueue::kKept + 1) << "so the viewer can tell that it missed events";
  EXPECT_EQ(event_after(queue, next), "");
}

TEST(EventQueue, AClosedOneHasNoEvents) {
  EventQueue queue;
  uint64_t next = queue.end();
  queue.push("a");
  queue.close();
  EXPECT_EQ(event_after(queue, next), "");
  EXPECT_TRUE(queue.closed());
}

}  // namespace
}  // namespace bevloc::firmware
