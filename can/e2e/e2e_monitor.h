// Watches the counters of one protected message and decides whether its frames can be used.
#pragma once

#include <cstdint>
#include <optional>

#include "can/e2e/e2e.h"
#include "can/e2e/e2e_state.h"
#include "common/time.h"

namespace bevloc::can {

struct E2eReceiverParameters {
  Duration cycle{};
  E2eStateParameters state{};
};

/// The parameters for a message of a GNSS receiver. The window has 20 cycles (2 s with a cycle of
/// 100 ms), and two frames in it suffice, so that a receiver with 1 Hz can be used.
E2eReceiverParameters gnss_receiver_parameters(Duration cycle);

/// The result of checking the protection of one frame, in any profile.
struct E2eFrame {
  bool right_length = false;
  bool right_crc = false;
  /// The counter, or nothing if the message has none. Then neither repeated nor lost frames are
  /// noticed.
  std::optional<uint8_t> counter{};
};

/// Checks the protection of a frame, whose message has `length` bytes.
E2eFrame e2e_frame_of(const Frame& frame, const E2eProtection& protection, uint8_t length);

/// The receiving side of the E2E profiles (AUTOSAR_PRS_E2EProtocol). It checks CRC, length,
/// repeated counter and MaxDeltaCounter, and synchronizes again after a wrong sequence. From these
/// checks E2eStateMachine decides. AUTOSAR counts the calls of a periodic task, while this class
/// computes the number of cycles from the time of arrival.
///
/// This class goes beyond the standard: while the sender is still there, a frame with a wrong
/// sequence does not change the expected counter. So frames of another sender are refused, and the
/// sender's own frames are used. One thread.
class E2eMonitor {
 public:
  /// Counters run from 0 to `highest_counter`. The caller sets `right_crc` to false for a frame
  /// with a higher one.
  E2eMonitor(uint8_t highest_counter, const E2eReceiverParameters& parameters)
      : highest_counter_(highest_counter), parameters_(parameters), machine_(parameters.state) {}

  /// Returns whether the frame can be used: it passed the check, and the state is VALID.
  bool accept(const E2eFrame& frame, Time received);

  E2eState state() const { return machine_.state(); }
  bool has_second_sender() const { return machine_.contradictions() >= kSecondSender; }
  const E2eCounters& counters() const { return counters_; }

 private:
  /// MaxDeltaCounterInit: by how much the counter may rise within one cycle. Each further cycle
  /// without a used frame allows one step more.
  static constexpr int kMaxDeltaCounter = 1;
  /// SyncCounterInit: frames in sequence that prove a new sender after a wrong sequence.
  static constexpr int kSyncFrames = 3;
  /// A sender that was silent for this many cycles may be replaced by another one.
  static constexpr int kSilentCycles = 4;
  /// This number of repeated or wrong counters in the window shows a second sender.
  static constexpr int kSecondSender = 5;

  E2eCheck check(const E2eFrame& frame, Time received);
  E2eCheck check_counter(uint8_t counter, Time received);
  /// Follows a sequence that is not the used one. Returns true when it has proven itself.
  bool follow(uint8_t counter);
  int delta(uint8_t counter, uint8_t before) const {
    const int count = highest_counter_ + 1;
    return (counter - before + count) % count;
  }
  void add_missing_cycles(Time received);

  uint8_t highest_counter_;
  E2eReceiverParameters parameters_;
  E2eStateMachine machine_;
  std::optional<Time> arrival_;  ///< when the latest frame arrived, usable or not

  std::optional<uint8_t> counter_;        ///< counter of the latest frame in sequence
  Time in_sequence_{};                    ///< when that frame arrived
  std::optional<uint8_t> other_counter_;  ///< counter of another sequence, which may take over
  int other_run_ = 0;
  E2eCounters counters_;
};

}  // namespace bevloc::can
