// In the steady state frames travel from a pool to a set and back without touching the heap.
#include <gtest/gtest.h>

#include "drivers/camera/frame_pool.h"
#include "drivers/frameset/bounded_queue.h"
#include "drivers/frameset/synchronizer.h"
#include "tests/support/allocation_counter.h"

namespace bevloc::drivers {
namespace {

using std::chrono::milliseconds;

TEST(SteadyState, AllocatesNothing) {
  std::array<std::shared_ptr<FramePool>, kCameraCount> pools;
  for (auto& pool : pools) pool = FramePool::create(4, 8, 8);
  BoundedQueue<Frame> frames(2 * kCameraCount);
  BoundedQueue<Frameset> sets(1);
  FramesetSynchronizer synchronizer({.tolerance = milliseconds(2), .wait = milliseconds(60)});

  const int before = test::allocation_count();
  int complete = 0;
  for (int k = 1; k <= 100; ++k) {
    const Time time(milliseconds(100) * k);
    const Time now = time + milliseconds(20);
    for (int camera = 0; camera < kCameraCount; ++camera) {
      const bool is_dropped = camera == k % 10;
      if (is_dropped) continue;
      Frame frame{camera, time, static_cast<uint64_t>(k), {}, pools[camera]->borrow()};
      ASSERT_TRUE(frame.buffer);
      frames.push(std::move(frame));
    }
    while (auto frame = frames.pop(Duration::zero())) synchronizer.add(std::move(*frame), now);
    while (auto set = synchronizer.poll(time + milliseconds(60))) sets.push(std::move(*set));
    const auto newest = sets.pop(Duration::zero());
    ASSERT_TRUE(newest);
    complete += newest->present.all() ? 1 : 0;
  }
  EXPECT_EQ(test::allocation_count() - before, 0);
  EXPECT_EQ(complete, 40);
  for (const auto& pool : pools) EXPECT_EQ(pool->lent(), 0);
}

}  // namespace
}  // namespace bevloc::drivers
