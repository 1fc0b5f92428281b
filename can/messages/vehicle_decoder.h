// The interface of decoders, which take odometry and GNSS from the vehicle's CAN frames.
#pragma once

#include <cstdint>
#include <optional>

#include "can/bus/frame.h"
#include "can/e2e/e2e.h"
#include "common/health_state.h"
#include "common/vehicle_samples.h"

namespace bevloc::can {

struct VehicleInputCounters {
  uint64_t foreign = 0;  ///< frames that are neither the vehicle's nor LOC_ messages
  uint64_t own_ids = 0;  ///< frames of another node with an identifier of a LOC_ message
  uint64_t wrong_crc = 0;
  uint64_t wrong_length = 0;
  uint64_t repeated = 0;
  uint64_t wrong_sequence = 0;        ///< the counter does not continue the sequence
  uint64_t not_valid = 0;             ///< good frames of a message that is not VALID (E2eMonitor)
  uint64_t lost = 0;                  ///< missing frames, detected by the counter
  uint64_t incomplete = 0;            ///< epochs with a missing message
  uint64_t not_available = 0;         ///< complete epochs with a signal that is SNA or out of range
  uint64_t contradicting_wheels = 0;  ///< odometry refused: the wheels contradict the yaw rate
  uint64_t odometry_jumps = 0;        ///< odometry refused: faster changes than a vehicle can make
  uint64_t sharp_turns = 0;           ///< odometry refused: sharper turns than a vehicle can make
  uint64_t slow_odometry = 0;         ///< odometry samples that came too rarely
  uint64_t odometry_samples = 0;
  uint64_t gnss_samples = 0;

  /// Adds what was counted for one message.
  void add(const E2eCounters& message) {
    wrong_crc += message.wrong_crc;
    wrong_length += message.wrong_length;
    repeated += message.repeated;
    wrong_sequence += message.wrong_sequence;
    not_valid += message.not_valid;
    lost += message.lost;
  }
};

/// The samples that one frame completes.
struct VehicleSamples {
  std::optional<OdometrySample> odometry{};
  std::optional<GnssSample> gnss{};

  /// Whether there is a sample.
  explicit operator bool() const { return odometry || gnss; }
};

/// When the vehicle's messages were last wrong.
struct VehicleFaultTimes {
  /// How long why() reports a fault after it occurred.
  static constexpr Duration kHold = std::chrono::seconds(1);

  std::optional<Time> implausible{};  ///< when odometry was refused, INVALID or too slow
  /// When another node sent LOC_ messages, or two nodes sent the same message.
  std::optional<Time> foreign_sender{};

  /// Returns kOdometryImplausible, kForeignSender, both or none: the faults that are at most
  /// `kHold` old at `now`.
  WhyMask why(Time now) const {
    const auto is_recent = [now](const std::optional<Time>& fault) {
      return fault && now - *fault <= kHold;
    };
    WhyMask why;
    if (is_recent(implausible)) why |= Why::kOdometryImplausible;
    if (is_recent(foreign_sender)) why |= Why::kForeignSender;
    return why;
  }
};

/// Samples are always finite, and odometry is plausible (OdometryCheck). The caller has to detect
/// time-outs from the time of the last sample. accept() does not allocate. One thread.
class VehicleDecoder {
 public:
  virtual ~VehicleDecoder() = default;

  /// Returns the samples that this frame completes: none, one, or one of each kind.
  virtual VehicleSamples accept(const ReceivedFrame& received) = 0;

  /// Call it after the machine was suspended. The clock stood still meanwhile, so a change of speed
  /// since then is no jump.
  virtual void note_gap() = 0;

  virtual VehicleInputCounters counters() const = 0;

  virtual VehicleFaultTimes fault_times() const = 0;
};

}  // namespace bevloc::can
