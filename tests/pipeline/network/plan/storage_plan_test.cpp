#include "pipeline/network/plan/storage_plan.h"

#include <gtest/gtest.h>

namespace bevloc::nn {
namespace {

bool share_memory(const StoragePlan& plan, size_t a, size_t b) {
  const MemoryPlan memory = plan_memory(plan.lifetimes());
  return memory.offsets[a] == memory.offsets[b];
}

/// Adds a task that uses a new storage.
size_t task_on_new_storage(StoragePlan& plan) {
  const size_t storage = plan.add(64);
  plan.use(storage);
  plan.next_task();
  return storage;
}

TEST(StoragePlan, WhatIsNoLongerReadGivesItsMemoryAway) {
  StoragePlan plan;
  const size_t first = task_on_new_storage(plan);
  const size_t second = task_on_new_storage(plan);
  EXPECT_TRUE(share_memory(plan, first, second));
  EXPECT_TRUE(plan.is_temporary(first));
}

TEST(StoragePlan, WhatIsReadLaterKeepsIt) {
  StoragePlan plan;
  const size_t first = task_on_new_storage(plan);
  const size_t second = plan.add(64);
  plan.use(first);
  plan.use(second);
  EXPECT_FALSE(share_memory(plan, first, second));
}

TEST(StoragePlan, AnotherBranchMayReuseTheMemory) {
  StoragePlan plan;
  const size_t first = task_on_new_storage(plan);
  plan.begin_branch(1);
  EXPECT_TRUE(share_memory(plan, first, task_on_new_storage(plan)));
}

TEST(StoragePlan, WhatAnotherBranchReadsIsSafeFromEveryBranch) {
  StoragePlan plan;
  const size_t before = task_on_new_storage(plan);
  plan.begin_branch(1);
  const size_t read_later = task_on_new_storage(plan);
  plan.begin_branch(2);
  plan.use(read_later);
  plan.next_task();
  const size_t after = task_on_new_storage(plan);
  EXPECT_FALSE(plan.is_temporary(read_later));
  EXPECT_FALSE(share_memory(plan, before, read_later)) << "branch 0 may run between 1 and 2";
  EXPECT_FALSE(share_memory(plan, read_later, after));
}

TEST(StoragePlan, OutputsAreSafeFromEarlierBranches) {
  StoragePlan plan;
  const size_t before = task_on_new_storage(plan);
  plan.begin_branch(1);
  const size_t output = task_on_new_storage(plan);
  plan.keep(output);
  EXPECT_FALSE(share_memory(plan, before, output)) << "branch 0 may run after 1";
}

}  // namespace
}  // namespace bevloc::nn
