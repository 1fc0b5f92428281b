// Receives one protected message: checks each frame and decides whether it can be used.
#pragma once

#include <cstdint>
#include <optional>

#include "can/e2e/e2e.h"
#include "can/e2e/e2e_state.h"
#include "common/time.h"

namespace bevloc::can {

struct E2eReceiverParameters {
  Duration cycle{};
  /// MaxDeltaCounterInit: by how much the counter may rise within one cycle. Each further cycle
  /// without a used frame allows one step more.
  int max_delta_counter = 1;
  /// SyncCounterInit: frames in sequence that prove a new sender after a wrong sequence.
  int sync_frames = 3;
  /// A sender that was silent for this many cycles may be replaced by another one.
  int silent_cycles = 4;
  /// So many repeated or wrong counters in the window show a second sender.
  int second_sender = 5;
  E2eStateParameters state{};
};

/// The receiving side of the profiles P02 and P05 (AUTOSAR_PRS_E2EProtocol): CRC, length, repeated
/// counter, MaxDeltaCounter, and resynchronisation after a wrong sequence, on top of which
/// E2eStateMachine decides. AUTOSAR counts calls of a periodic task; here the time of arrival
/// counts the cycles.
///
/// Beyond the standard, a wrong sequence does not move the counter of a sender that is still there:
/// frames that somebody else sends in between are refused, and the sender's own are used. One
/// thread.
class E2eReceiver {
 public:
  E2eReceiver(const E2eProtection& protection, uint8_t length,
              const E2eReceiverParameters& parameters);

  /// Returns whether the frame can be used: it passed the check, and the state is VALID.
  bool accept(const ReceivedFrame& received);

  E2eState state() const { return machine_.state(); }
  bool has_second_sender() const { return machine_.contradictions() >= parameters_.second_sender; }
  const E2eCounters& counters() const { return counters_; }

 private:
  E2eCheck check(const ReceivedFrame& received);
  E2eCheck check_counter(uint8_t counter, Time received);
  /// Follows a sequence that is not the used one. Returns true when it has proven itself.
  bool follow(uint8_t counter);
  int delta(uint8_t counter, uint8_t before) const;
  void add_missing_cycles(Time received);

  E2eProtection protection_;
  uint8_t length_;
  E2eReceiverParameters parameters_;
  E2eStateMachine machine_;
  std::optional<Time> arrival_;  ///< of the latest frame, usable or not

  std::optional<uint8_t> counter_;        ///< of the latest frame in sequence
  Time in_sequence_{};                    ///< when it arrived
  std::optional<uint8_t> other_counter_;  ///< of a sequence that may replace it
  int other_run_ = 0;
  E2eCounters counters_;
};

}  // namespace bevloc::can
