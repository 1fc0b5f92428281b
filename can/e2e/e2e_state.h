// The AUTOSAR state machine that decides from several checks whether a message can be used.
#pragma once

#include <cstdint>

namespace bevloc::can {

/// The result of one check, for the state machine (E2E_PCheckStatusType).
enum class E2eCheck : uint8_t {
  kOk,             ///< a usable frame
  kError,          ///< wrong CRC or length
  kRepeated,       ///< the counter of the previous frame
  kWrongSequence,  ///< a counter that does not continue the sequence
  kNoNewData,      ///< a cycle without a frame
};

enum class E2eState : uint8_t { kNoData, kInit, kValid, kInvalid };

/// The numbers of E2E_SMConfigType (AUTOSAR_PRS_E2EProtocol, "E2E state machine").
struct E2eStateParameters {
  int window = 10;      ///< number of checks that count, at most 32
  int min_ok_init = 1;  ///< usable frames for the change from INIT to VALID
  int max_error_init = 0;
  int min_ok_valid = 1;  ///< with fewer usable frames, VALID becomes INVALID
  int max_error_valid = 3;
  int min_ok_invalid = 5;  ///< usable frames for the change from INVALID to VALID
  int max_error_invalid = 1;
};

/// E2E_SMCheck of AUTOSAR, with three deviations. Two are to the safe side: A repeated frame counts
/// as an error, because two senders of one message repeat each other's counters. INIT does not
/// become INVALID, because no frame is used in either state. The third one is not: if one good
/// frame suffices for VALID, the first good frame after the start is used at once, while AUTOSAR
/// leaves INIT only with the second frame. The first frame may be an old one that waited in the
/// sender's controller. No pose is valid so early. One thread.
class E2eStateMachine {
 public:
  explicit E2eStateMachine(const E2eStateParameters& parameters) : parameters_(parameters) {}

  E2eState add(E2eCheck check);
  E2eState state() const { return state_; }

  /// Number of checks in the window that show a second sender: repeated counters and wrong
  /// sequences.
  int contradictions() const;

  /// Forgets the checks in the window and keeps the state.
  void clear_window();

 private:
  bool meets(int min_ok, int max_error) const;

  E2eStateParameters parameters_;
  E2eState state_ = E2eState::kNoData;
  uint32_t ok_ = 0;  ///< bit i: the check i checks ago was OK
  uint32_t error_ = 0;
  uint32_t contradiction_ = 0;
};

}  // namespace bevloc::can
