#include "can/e2e/e2e_state.h"

#include <bit>

namespace bevloc::can {

E2eState E2eStateMachine::add(E2eCheck check) {
  const uint32_t mask = UINT32_MAX >> (32 - parameters_.window);
  const bool repeated = check == E2eCheck::kRepeated;
  const auto shift_in = [mask](uint32_t& bits, bool set) { bits = (bits << 1 | set) & mask; };
  shift_in(ok_, check == E2eCheck::kOk);
  shift_in(error_, repeated || check == E2eCheck::kError);
  shift_in(contradiction_, repeated || check == E2eCheck::kWrongSequence);

  const E2eStateParameters& p = parameters_;
  switch (state_) {
    case E2eState::kNoData:
      if (check == E2eCheck::kError || check == E2eCheck::kNoNewData) break;
      state_ = E2eState::kInit;
      [[fallthrough]];
    case E2eState::kInit:
      if (meets(p.min_ok_init, p.max_error_init)) state_ = E2eState::kValid;
      break;
    case E2eState::kValid:
      if (!meets(p.min_ok_valid, p.max_error_valid)) state_ = E2eState::kInvalid;
      break;
    case E2eState::kInvalid:
      if (meets(p.min_ok_invalid, p.max_error_invalid)) state_ = E2eState::kValid;
      break;
  }
  return state_;
}

int E2eStateMachine::contradictions() const {
  return std::popcount(contradiction_);
}

void E2eStateMachine::clear_window() {
  ok_ = error_ = contradiction_ = 0;
}

bool E2eStateMachine::meets(int min_ok, int max_error) const {
  return std::popcount(ok_) >= min_ok && std::popcount(error_) <= max_error;
}

}  // namespace bevloc::can
