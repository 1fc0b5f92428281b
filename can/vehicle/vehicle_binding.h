// Which signals of the vehicle's own DBC file carry odometry and GNSS.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "can/dbc/available_values.h"
#include "can/dbc/signal_layout.h"
#include "can/vehicle/message_protection.h"
#include "common/time.h"

namespace bevloc::can {

struct BoundMessage {
  std::string name;
  uint32_t id = 0;  ///< 11 bits
  uint8_t length = 0;
  Duration cycle{};
  MessageProtection protection;
  bool has_odometry = false;  ///< carries a value of odometry, not only one of GNSS
};

struct BoundSignal {
  /// The multiplexor of a signal that only some frames of the message have.
  struct Multiplexed {
    SignalLayout multiplexor;
    uint64_t value = 0;
  };

  std::string name;    ///< "Message.Signal"
  size_t message = 0;  ///< index into VehicleBinding::messages
  SignalLayout layout;
  std::optional<Multiplexed> multiplexed{};
  AvailableValues available{};  ///< in the unit of the DBC file
  /// Whether a speed or a yaw rate reaches negative values (kSignedSpeed_mps,
  /// kSignedYawRate_radps).
  bool has_sign = false;
  double factor = 1.0;  ///< from the unit of the DBC file to that of Quantity
};

/// The step of a signal in the unit of its quantity. It is 0 for floats.
double step_of(const BoundSignal& signal);

// A signal has a sign only if layout and range let it reach this value. A range of a magnitude may
// begin just below 0, because the limit was rounded.
constexpr double kSignedSpeed_mps = -1.0;
constexpr double kSignedYawRate_radps = -0.3;

/// A condition that holds while the raw value of a signal is one of `values`.
struct BoundCondition {
  size_t signal = 0;
  std::vector<int64_t> values;
};

enum class WheelPlace : uint8_t {
  kRearLeft,
  kRearRight,
  kFrontLeft,
  kFrontRight,
  kVehicle,  ///< the middle of the rear axle, as a speedometer shows it
};

struct BoundWheels {
  struct Wheel {
    size_t signal = 0;
    WheelPlace place = WheelPlace::kVehicle;
  };
  std::vector<Wheel> wheels;
  double wheelbase_m = 0.0;  ///< needed for front wheels only
  std::optional<BoundCondition> valid{};
  std::optional<BoundCondition> backward{};  ///< the vehicle reverses: speeds are negative
};

struct BoundYawRate {
  size_t signal = 0;
  bool positive_right = false;  ///< positive clockwise
  std::optional<BoundCondition> valid{};
  std::optional<BoundCondition> negative{};  ///< the signal is a magnitude, and this is its sign
};

struct BoundGnss {
  size_t latitude = 0;
  size_t longitude = 0;
  std::optional<BoundCondition> valid{};
  double sigma_m = 0.0;                 ///< used if there are no signals of the sigmas
  std::optional<size_t> sigma_north{};  ///< may be the same signal as sigma_east
  std::optional<size_t> sigma_east{};
  std::optional<size_t> heading{};
  std::optional<BoundCondition> heading_valid{};
  double sigma_heading_deg = 0.0;
  std::optional<size_t> sigma_heading{};
};

/// The longest cycle that a message of odometry may have.
constexpr double kSlowestOdometry_ms = 40.0;

/// All that DbcVehicleInput reads.
struct VehicleBinding {
  std::string dbc_file;
  std::vector<BoundMessage> messages;
  std::vector<BoundSignal> signals;
  BoundWheels wheels;
  BoundYawRate yaw_rate;
  std::optional<BoundGnss> gnss{};  ///< empty if GNSS comes from elsewhere
};

/// Identifiers that a filter of the bus has to let pass.
std::vector<uint32_t> ids_of(const VehicleBinding& binding);

/// Whether a message has more bytes than a classic frame.
bool needs_fd(const VehicleBinding& binding);

/// The time from one sample of odometry to the next: the cycle of the slowest message, from 20 to
/// 40 ms. It is 40 ms if a signal is multiplexed, because the sender decides how often such a
/// signal comes.
Duration odometry_interval(const VehicleBinding& binding);

/// Whether the steps of a wheel or of the yaw rate are so fine that noise changes the value from
/// sample to sample while the vehicle drives. If they are coarse, a sensor without a fault repeats
/// its values.
bool has_fine_steps(const VehicleBinding& binding);

/// Names the faults that a receiver cannot notice: those of messages without counter or checksum,
/// and those of odometry with coarse steps.
std::vector<std::string> warnings_of(const VehicleBinding& binding);

}  // namespace bevloc::can
