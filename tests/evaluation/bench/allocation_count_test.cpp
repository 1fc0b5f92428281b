#include "evaluation/bench/allocation_count.h"

#include <cerrno>
#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>

namespace bevloc::bench {
namespace {

/// Keeps the compiler from removing an unused allocation.
void keep(void* memory) {
  asm volatile("" : : "g"(memory) : "memory");
}

TEST(AllocationCount, CountsOperatorNewOnce) {
  struct alignas(64) Aligned {
    char bytes[100];
  };
  const uint64_t before = allocation_count();
  for (int i = 0; i < 3; ++i) {
    const auto made = std::make_unique<int>(i);
    keep(made.get());
  }
  const auto aligned = std::make_unique<Aligned>();
  keep(aligned.get());
  EXPECT_EQ(allocation_count() - before, 4U);
  EXPECT_EQ(reinterpret_cast<uintptr_t>(aligned.get()) % 64, 0U);
}

TEST(AllocationCount, CountsEveryKindOfMalloc) {
  if (!malloc_is_counted()) GTEST_SKIP() << "a sanitizer replaces malloc";
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

TEST(AllocationCount, DoesNotCountUseAndRelease) {
  auto values = std::make_unique<std::vector<int>>(100);
  keep(values.get());
  const uint64_t before = allocation_count();
  for (int& value : *values) value = 1;
  values.reset();
  EXPECT_EQ(allocation_count(), before);
}

TEST(AllocationCount, CountsAllThreads) {
  const uint64_t before = allocation_count();
  std::jthread([] {
    for (int i = 0; i < 100; ++i) keep(std::make_unique<int>(i).get());
  }).join();
  EXPECT_GE(allocation_count() - before, 100U);
}

TEST(AllocationCount, RefusesAnInvalidAlignmentAsPosixDoes) {
  if (!malloc_is_counted()) GTEST_SKIP() << "a sanitizer replaces malloc";
  void* memory = nullptr;
  const volatile size_t invalid = 24;
  EXPECT_EQ(posix_memalign(&memory, invalid, 100), EINVAL);
}

TEST(AllocationCallers, AreRecordedWhileTheObjectLives) {
  keep(std::make_unique<int>(1).get());
  AllocationCallers callers;
  keep(std::make_unique<int>(2).get());
  keep(std::make_unique<int>(3).get());
  EXPECT_EQ(callers.outside_of("libdnnl"), 2);
}

}  // namespace
}  // namespace bevloc::bench
