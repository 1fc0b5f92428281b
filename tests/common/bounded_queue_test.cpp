#include "common/bounded_queue.h"

#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

TEST(BoundedQueue, GivesOutInOrder) {
  BoundedQueue<int> queue(3);
  for (const int value : {1, 2, 3}) queue.push(value);
  for (const int value : {1, 2, 3}) EXPECT_EQ(queue.pop(Duration::zero()), value);
  EXPECT_EQ(queue.pop(Duration::zero()), std::nullopt);
  EXPECT_EQ(queue.dropped(), 0U);
}

TEST(BoundedQueue, FullQueueDropsTheOldestAndCounts) {
  BoundedQueue<int> queue(2);
  for (const int value : {1, 2, 3, 4, 5}) queue.push(value);
  EXPECT_EQ(queue.dropped(), 3U);
  EXPECT_EQ(queue.pop(Duration::zero()), 4);
  EXPECT_EQ(queue.pop(Duration::zero()), 5);
}

TEST(BoundedQueue, CapacityOneHoldsTheLatest) {
  BoundedQueue<std::unique_ptr<int>> slot(1);
  for (int i = 0; i < 10; ++i) slot.push(std::make_unique<int>(i));
  EXPECT_EQ(**slot.pop(Duration::zero()), 9);
  EXPECT_EQ(slot.dropped(), 9U);
}

TEST(BoundedQueue, DropsReleaseWhatTheyHeld) {
  const auto tracked = std::make_shared<int>(0);
  BoundedQueue<std::shared_ptr<int>> queue(2);
  for (int i = 0; i < 5; ++i) queue.push(tracked);
  EXPECT_EQ(tracked.use_count(), 3);
  queue.pop(Duration::zero());
  EXPECT_EQ(tracked.use_count(), 2);
}

TEST(BoundedQueue, NeedsNeitherCopyNorDefaultConstructor) {
  struct Entry {
    explicit Entry(int value) : content(std::make_unique<int>(value)) {}
    std::unique_ptr<int> content;
  };
  BoundedQueue<Entry> queue(2);
  for (int i = 0; i < 3; ++i) queue.push(Entry(i));
  EXPECT_EQ(*queue.pop(Duration::zero())->content, 1);
}

TEST(BoundedQueue, DestroysADroppedEntryOutsideItsLock) {
  struct Entry {
    BoundedQueue<std::shared_ptr<Entry>>* queue;
    uint64_t* dropped;
    ~Entry() { *dropped = queue->dropped(); }
  };
  uint64_t dropped = 0;
  BoundedQueue<std::shared_ptr<Entry>> queue(1);
  queue.push(std::make_shared<Entry>(&queue, &dropped));
  queue.push(nullptr);
  EXPECT_EQ(dropped, 1U);
}

TEST(BoundedQueue, CloseWakesAReaderAndKeepsWhatIsInside) {
  BoundedQueue<int> queue(2);
  std::thread reader([&] { EXPECT_EQ(queue.pop(std::chrono::hours(1)), std::nullopt); });
  queue.close();
  reader.join();
  EXPECT_TRUE(queue.closed());

  BoundedQueue<int> filled(2);
  filled.push(1);
  filled.close();
  filled.push(2);
  EXPECT_EQ(filled.pop(std::chrono::hours(1)), 1);
  EXPECT_EQ(filled.pop(std::chrono::hours(1)), std::nullopt);
}

TEST(BoundedQueue, EveryEntryIsReadOrCountedAmongThreads) {
  constexpr int kWriters = 3;
  constexpr int kEach = 3000;
  BoundedQueue<std::pair<int, int>> queue(4);
  std::vector<std::thread> writers;
  for (int w = 0; w < kWriters; ++w) {
    writers.emplace_back([&queue, w] {
      for (int i = 0; i < kEach; ++i) queue.push({w, i});
    });
  }
  uint64_t read = 0;
  std::thread reader([&] {
    std::vector<int> latest(kWriters, -1);
    while (const auto entry = queue.pop(std::chrono::hours(1))) {
      EXPECT_GT(entry->second, latest[entry->first]);
      latest[entry->first] = entry->second;
      ++read;
    }
  });
  for (std::thread& writer : writers) writer.join();
  queue.close();
  reader.join();
  EXPECT_GT(read, 0U);
  EXPECT_EQ(read + queue.dropped(), static_cast<uint64_t>(kWriters) * kEach);
}

}  // namespace
}  // namespace bevloc
