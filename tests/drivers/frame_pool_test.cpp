#include "drivers/camera/frame_pool.h"

#include <atomic>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace bevloc::drivers {
namespace {

TEST(FramePool, LendsEachBufferOnceAndThenNone) {
  for (const int buffers : {1, 3, FramePool::kMaxBuffers}) {
    const auto pool = FramePool::create(buffers, 4, 2);
    std::vector<FrameBuffer> held;
    std::set<const uint8_t*> addresses;
    for (int i = 0; i < buffers; ++i) {
      held.push_back(pool->borrow());
      ASSERT_TRUE(held.back());
      EXPECT_EQ(held.back().view().width, 4);
      EXPECT_EQ(held.back().view().height, 2);
      addresses.insert(held.back().view().planes[0].data);
    }
    EXPECT_EQ(static_cast<int>(addresses.size()), buffers);
    EXPECT_FALSE(pool->borrow());
    EXPECT_EQ(pool->lent(), buffers);
    held.pop_back();
    EXPECT_EQ(pool->lent(), buffers - 1);
    EXPECT_TRUE(pool->borrow());
  }
}

TEST(FramePool, MovingABufferNeitherLendsNorReturns) {
  const auto pool = FramePool::create(2, 1, 1);
  FrameBuffer a = pool->borrow();
  FrameBuffer b = std::move(a);
  EXPECT_FALSE(a);  // NOLINT(bugprone-use-after-move): the moved-from state is tested
  EXPECT_EQ(pool->lent(), 1);
  FrameBuffer c = pool->borrow();
  EXPECT_EQ(pool->lent(), 2);
  c = std::move(b);  // returns the buffer that c held
  EXPECT_EQ(pool->lent(), 1);
  c = FrameBuffer{};
  EXPECT_EQ(pool->lent(), 0);
}

TEST(FramePool, ABufferOutlivesThePool) {
  auto pool = FramePool::create(1, 2, 2);
  FrameBuffer buffer = pool->borrow();
  pool->image(buffer).pixels.back() = 7;
  pool.reset();
  EXPECT_EQ(buffer.view().rgb().row(1)[5], 7);
}

TEST(FramePool, NoBufferIsLentToTwoThreads) {
  constexpr int kThreads = 4;
  constexpr int kRounds = 2000;
  const auto pool = FramePool::create(3, 1, 1);
  std::atomic<int> clashes{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < kRounds; ++i) {
        FrameBuffer buffer = pool->borrow();
        if (!buffer) continue;
        // Unsynchronised on purpose: a buffer that is lent twice causes a data race or a clash.
        pool->image(buffer).pixels[0] = static_cast<uint8_t>(t);
        if (buffer.view().planes[0].data[0] != t) ++clashes;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(clashes, 0);
  EXPECT_EQ(pool->lent(), 0);
}

}  // namespace
}  // namespace bevloc::drivers
