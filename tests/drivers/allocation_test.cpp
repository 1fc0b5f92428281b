// Tests that frames do not allocate in the steady state, from the pool to a frameset and back.
#include <gtest/gtest.h>

#include "common/bounded_queue.h"
#include "drivers/camera/frame_pool.h"
#include "drivers/frameset/synchronizer.h"
#include "evaluation/bench/allocation_count.h"

namespace bevloc::drivers {
namespace {

using std::chrono::milliseconds;

TEST(Allocation, NoneBetweenPoolAndFrameset) {
  std::array<std::shared_ptr<FramePool>, kCameraCount> pools;
  for (auto& pool : pools) pool = FramePool::create(4, 8, 8);
  BoundedQueue<Frame> frames(2 * kCameraCount);
  BoundedQueue<Frameset> sets(1);
  FramesetSynchronizer synchronizer({.tolerance = milliseconds(2), .wait = milliseconds(60)});

  const uint64_t before = bench::allocation_count();
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
  EXPECT_EQ(bench::allocation_count() - before, 0U);
  EXPECT_EQ(complete, 40);
  for (const auto& pool : pools) EXPECT_EQ(pool->lent(), 0);
}

}  // namespace
}  // namespace bevloc::drivers
