// The faults of a running simulated drive, which may be set and cleared while it runs.
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "sim/faults/fault.h"
#include "sim/faults/fault_table.h"

namespace bevloc::sim {

struct NumberedFault {
  uint32_t number = 0;
  Fault fault;
};

/// Thread-safe. Whoever simulates an input asks for its faults at each sample.
class FaultBoard {
 public:
  FaultBoard() = default;
  explicit FaultBoard(const std::vector<Fault>& faults);

  /// Returns the number by which the fault can be removed.
  uint32_t add(const Fault& fault);
  /// Returns false if there is no fault of this number.
  bool remove(uint32_t number);
  void clear();
  std::vector<NumberedFault> list() const;

  /// The faults of an input at a time of the drive, in the order in which they were added.
  std::vector<Fault> active(FaultInput input, double time_s) const;
  /// The faults of one camera.
  std::vector<Fault> active_on_camera(int camera, double time_s) const;

 private:
  mutable std::mutex mutex_;
  std::vector<NumberedFault> faults_;  // guarded by mutex_
  uint32_t next_number_ = 1;           // guarded by mutex_
};

}  // namespace bevloc::sim
