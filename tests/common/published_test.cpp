#include "common/published.h"

#include <thread>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

struct Counters {
  uint64_t a = 0;
  std::array<uint32_t, 33> more{};
};

Counters all(uint32_t number) {
  Counters counters{number, {}};
  counters.more.fill(number);
  return counters;
}

TEST(PublishedTest, HoldsTheLatestValue) {
  Published<Counters> published;
  EXPECT_EQ(published.load().a, 0U);
  published.store(all(7));
  EXPECT_EQ(published.load().a, 7U);
  EXPECT_EQ(published.load().more[32], 7U);
}

/// A value whose writer can stop in the middle of a store.
class HalfStored : public Published<Counters> {
 public:
  using Published<Counters>::begin_store;
  using Published<Counters>::end_store;
};

TEST(PublishedTest, TryLoadDoesNotWaitForTheWriter) {
  HalfStored published;
  published.store(all(7));
  published.begin_store();
  EXPECT_FALSE(published.try_load());
  published.end_store();
  const auto loaded = published.try_load();
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->a, 7U);
  EXPECT_EQ(loaded->more[32], 7U);
}

TEST(PublishedTest, AReaderNeverSeesHalfAValue) {
  constexpr uint32_t kValues = 20'000;
  Published<Counters> published;
  std::jthread writer([&published] {
    for (uint32_t value = 1; value <= kValues; ++value) published.store(all(value));
  });
  uint64_t last = 0;
  while (last < kValues) {
    const Counters counters = published.load();
    EXPECT_GE(counters.a, last);
    last = counters.a;
    for (const uint32_t value : counters.more) ASSERT_EQ(value, last);
  }
}

}  // namespace
}  // namespace bevloc
