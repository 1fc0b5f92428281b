#include "pipeline/network/plan/storage_plan.h"

#include <algorithm>
#include <limits>

namespace bevloc::nn {
namespace {

/// The value of `last` for a storage that must survive its branch.
constexpr int kForever = std::numeric_limits<int>::max();

}  // namespace

size_t StoragePlan::add(size_t bytes) {
  lifetimes_.push_back({bytes, now_, now_});
  branch_of_.push_back(branch_);
  return lifetimes_.size() - 1;
}

void StoragePlan::grow(size_t storage, size_t bytes) {
  lifetimes_[storage].bytes = std::max(lifetimes_[storage].bytes, bytes);
}

void StoragePlan::use(size_t storage) {
  if (branch_of_[storage] != branch_) return keep(storage);
  lifetimes_[storage].last = std::max(lifetimes_[storage].last, now_);
}

void StoragePlan::keep(size_t storage) {
  // Earlier branches may run again after this one, so they must not use this memory either. The
  // first branch has no earlier one, and its own earlier tasks run before it rewrites the storage.
  if (branch_of_[storage] > 0) lifetimes_[storage].first = 0;
  lifetimes_[storage].last = kForever;
}

bool StoragePlan::is_temporary(size_t storage) const {
  return branch_of_[storage] == branch_ && lifetimes_[storage].last != kForever;
}

}  // namespace bevloc::nn
