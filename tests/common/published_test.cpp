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
