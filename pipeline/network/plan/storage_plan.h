// Records during which tasks each storage is in use, while the tasks are being planned.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/network/plan/memory_plan.h"

namespace bevloc::nn {

/// A storage is a piece of the arena that one or more buffers use. Time is counted in tasks, over
/// all branches in order.
///
/// A storage that only one branch uses can share memory with any other storage. A storage that must
/// survive its branch shares with none, because branches run in any order and repeatedly.
class StoragePlan {
 public:
  /// Adds a storage that the current task uses, and returns its index.
  size_t add(size_t bytes);
  /// Makes the storage at least `bytes` large.
  void grow(size_t storage, size_t bytes);
  /// Notes that the current task reads or writes the storage.
  void use(size_t storage);
  /// Notes that the content of the storage must survive until its branch runs again.
  void keep(size_t storage);

  void begin_branch(size_t branch) { branch_ = branch; }
  size_t branch() const { return branch_; }
  void next_task() { ++now_; }

  /// Whether the storage belongs to the current branch and need not survive it.
  bool is_temporary(size_t storage) const;

  const std::vector<Lifetime>& lifetimes() const { return lifetimes_; }

 private:
  std::vector<Lifetime> lifetimes_;
  std::vector<size_t> branch_of_;
  size_t branch_ = 0;
  int now_ = 0;
};

}  // namespace bevloc::nn
