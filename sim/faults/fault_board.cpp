#include "sim/faults/fault_board.h"

#include <algorithm>

namespace bevloc::sim {
namespace {

/// How often a hanging thread looks whether its fault has ended by itself.
constexpr std::chrono::milliseconds kHangPoll{10};

}  // namespace

FaultBoard::FaultBoard(const std::vector<Fault>& faults) {
  for (const Fault& fault : faults) add(fault);
}

uint32_t FaultBoard::add(const Fault& fault) {
  const std::lock_guard lock(mutex_);
  faults_.push_back({next_number_, fault});
  return next_number_++;
}

void FaultBoard::note_past(const NumberedFault& listed, double now_s) {
  const bool has_begun = listed.fault.from_s <= now_s;
  if (listed.fault.kind == FaultKind::kClockSuspend && has_begun) past_.push_back(listed.fault);
}

bool FaultBoard::remove(uint32_t number, double now_s) {
  const std::lock_guard lock(mutex_);
  for (const NumberedFault& listed : faults_) {
    if (listed.number == number) note_past(listed, now_s);
  }
  return std::erase_if(faults_, [number](const NumberedFault& listed) {
           return listed.number == number;
         }) > 0;
}

void FaultBoard::clear(double now_s) {
  const std::lock_guard lock(mutex_);
  for (const NumberedFault& listed : faults_) note_past(listed, now_s);
  faults_.clear();
}

std::vector<NumberedFault> FaultBoard::list() const {
  const std::lock_guard lock(mutex_);
  return faults_;
}

std::vector<Fault> FaultBoard::active(FaultInput input, double time_s) const {
  const std::lock_guard lock(mutex_);
  std::vector<Fault> found;
  for (const NumberedFault& listed : faults_) {
    const bool of_input = info_of(listed.fault.kind).input == input;
    if (of_input && listed.fault.is_active(time_s)) found.push_back(listed.fault);
  }
  return found;
}

std::vector<Fault> FaultBoard::active_on_camera(int camera, double time_s) const {
  std::vector<Fault> found = active(FaultInput::kCamera, time_s);
  std::erase_if(found, [camera](const Fault& fault) { return !fault.concerns(camera); });
  return found;
}

std::vector<Fault> FaultBoard::all(FaultInput input) const {
  const std::lock_guard lock(mutex_);
  std::vector<Fault> found;
  if (input == FaultInput::kClock) found = past_;
  for (const NumberedFault& listed : faults_) {
    if (info_of(listed.fault.kind).input == input) found.push_back(listed.fault);
  }
  return found;
}

bool FaultBoard::hangs(FaultKind kind, int camera, double time_s) const {
  return !released_ && std::ranges::any_of(faults_, [&](const NumberedFault& listed) {
    const Fault& fault = listed.fault;
    return fault.kind == kind && fault.concerns(camera) && fault.is_active(time_s);
  });
}

bool FaultBoard::hang(FaultKind kind, int camera, const std::function<double()>& time_s) const {
  std::unique_lock lock(mutex_);
  bool hung = false;
  while (hangs(kind, camera, time_s())) {
    hung = true;
    changed_.wait_for(lock, kHangPoll);
  }
  return hung && released_;
}

void FaultBoard::release() {
  const std::lock_guard lock(mutex_);
  released_ = true;
  changed_.notify_all();
}

}  // namespace bevloc::sim
