#include "firmware/bench/allocation_count.h"

#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>

namespace bevloc::bench {
namespace {

/// The compiler may leave out an allocation that nobody sees.
void keep(void* memory) {
  asm volatile("" : : "g"(memory) : "memory");
}

class AllocationCount : public testing::Test {
 protected:
  void SetUp() override {
    if (!allocations_are_counted()) GTEST_SKIP() << "another allocator is in the way";
  }
};

TEST_F(AllocationCount, CountsOperatorNew) {
  const uint64_t before = allocation_count();
  for (int i = 0; i < 3; ++i) {
    const auto made = std::make_unique<int>(i);
    keep(made.get());
  }
  EXPECT_EQ(allocation_count() - before, 3U);
}

TEST_F(AllocationCount, CountsEveryKindOfMalloc) {
  const uint64_t before = allocation_count();
  void* const plain = std::malloc(10);
  void* const zeroed = std::calloc(2, 10);
  keep(plain);
  keep(zeroed);
  void* const larger = std::realloc(plain, 100'000);
  keep(larger);
  void* const aligned = std::aligned_alloc(64, 128);
  keep(aligned);
  void* posix = nullptr;
  EXPECT_EQ(posix_memalign(&posix, 256, 100), 0);
  EXPECT_EQ(allocation_count() - before, 5U);
  EXPECT_EQ(reinterpret_cast<uintptr_t>(aligned) % 64, 0U);
  EXPECT_EQ(reinterpret_cast<uintptr_t>(posix) % 256, 0U);
  for (void* memory : {zeroed, larger, aligned, posix}) std::free(memory);
}

TEST_F(AllocationCount, FreeingAndUsingMemoryDoNotCount) {
  auto values = std::make_unique<std::vector<int>>(100);
  keep(values.get());
  const uint64_t before = allocation_count();
  for (int& value : *values) value = 1;
  values.reset();
  EXPECT_EQ(allocation_count(), before);
}

TEST_F(AllocationCount, CountsOtherThreads) {
  const uint64_t before = allocation_count();
  std::jthread([] {
    for (int i = 0; i < 100; ++i) keep(std::make_unique<int>(i).get());
  }).join();
  EXPECT_GE(allocation_count() - before, 100U);
}

TEST_F(AllocationCount, RefusesAStrangeAlignmentAsPosixDoes) {
  void* memory = nullptr;
  const volatile size_t strange = 24;
  EXPECT_EQ(posix_memalign(&memory, strange, 100), EINVAL);
}

}  // namespace
}  // namespace bevloc::bench
