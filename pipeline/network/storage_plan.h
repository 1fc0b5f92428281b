// From when to when each piece of memory is needed, found while tasks are lined up.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/network/memory_plan.h"

namespace bevloc::nn {

/// Time is counted in tasks, through all branches in order. What lives within one branch may share
/// memory with anything else; what must outlive it is kept for good, because branches run in any
/// order and again.
class StoragePlan {
 public:
  /// A storage that the present task needs.
  size_t add(size_t bytes);
  void grow(size_t storage, size_t bytes);
  /// The present task reads or writes it.
  void use(size_t storage);
  void keep(size_t storage);

  void begin_branch(size_t branch) { branch_ = branch; }
  size_t branch() const { return branch_; }
  void next_task() { ++now_; }

  /// Whether nothing after the present branch may need it.
  bool is_temporary(size_t storage) const;

  const std::vector<Lifetime>& lifetimes() const { return lifetimes_; }

 private:
  std::vector<Lifetime> lifetimes_;
  std::vector<size_t> branch_of_;
  size_t branch_ = 0;
  int now_ = 0;
};

}  // namespace bevloc::nn
