// The faults of a running simulated drive, which may be set and cleared while it runs.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
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
  /// Removes a fault at a time of the drive. Returns false if there is no fault of this number.
  bool remove(uint32_t number, double now_s);
  void clear(double now_s);
  std::vector<NumberedFault> list() const;

  /// The faults of an input at a time of the drive, in the order in which they were added.
  std::vector<Fault> active(FaultInput input, double time_s) const;
  /// The faults of one camera.
  std::vector<Fault> active_on_camera(int camera, double time_s) const;
  /// All faults of an input, whatever their time. For the clock, these include removed suspensions
  /// that had begun, because the time of the drive never jumps back.
  std::vector<Fault> all(FaultInput input) const;

  /// Blocks while a fault of this kind hangs the calling thread, in real time. `time_s` gives the
  /// time of the drive. `camera` matters for kHangCapture only. Returns whether release() ended it.
  bool hang(FaultKind kind, int camera, const std::function<double()>& time_s) const;
  /// Ends every hang() for good, so that the threads can end.
  void release();

 private:
  bool hangs(FaultKind kind, int camera, double time_s) const;
  /// Keeps a suspension that has begun. Its effect stays when the fault is removed.
  void note_past(const NumberedFault& listed, double now_s);

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  bool released_ = false;              // guarded by mutex_
  std::vector<NumberedFault> faults_;  // guarded by mutex_
  std::vector<Fault> past_;            // removed suspensions; guarded by mutex_
  uint32_t next_number_ = 1;           // guarded by mutex_
};

}  // namespace bevloc::sim
