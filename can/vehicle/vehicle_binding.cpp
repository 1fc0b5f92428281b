#include "can/vehicle/vehicle_binding.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "can/bus/frame.h"
#include "can/messages/vehicle_messages.h"
#include "common/se2.h"

namespace bevloc::can {
namespace {

// About half of the noise that wheel speeds and yaw rates have in a vehicle that drives.
constexpr double kFineSpeed_mps = 0.02;
constexpr double kFineYawRate_radps = radians(0.05);

}  // namespace

double step_of(const BoundSignal& signal) {
  return is_integer(signal.layout) ? std::abs(signal.layout.scale) * signal.factor : 0.0;
}

std::vector<uint32_t> ids_of(const VehicleBinding& binding) {
  std::vector<uint32_t> ids;
  for (const BoundMessage& message : binding.messages) ids.push_back(message.id);
  return ids;
}

bool needs_fd(const VehicleBinding& binding) {
  return std::ranges::any_of(binding.messages, [](const BoundMessage& message) {
    return !is_valid_length(FrameFormat::kClassic, message.length);
  });
}

Duration odometry_interval(const VehicleBinding& binding) {
  const Duration slowest = from_milliseconds(kSlowestOdometry_ms);
  Duration interval = std::chrono::milliseconds(kOdometryCycleMs);
  const auto add = [&](size_t index) {
    const BoundSignal& signal = binding.signals[index];
    const Duration cycle = binding.messages[signal.message].cycle;
    interval = std::max(interval, signal.multiplexed ? slowest : cycle);
  };
  for (const BoundWheels::Wheel& wheel : binding.wheels.wheels) add(wheel.signal);
  add(binding.yaw_rate.signal);
  return std::min(interval, slowest);
}

bool has_fine_steps(const VehicleBinding& binding) {
  const auto is_fine = [&](const BoundWheels::Wheel& wheel) {
    return step_of(binding.signals[wheel.signal]) <= kFineSpeed_mps;
  };
  return std::ranges::any_of(binding.wheels.wheels, is_fine) ||
         step_of(binding.signals[binding.yaw_rate.signal]) <= kFineYawRate_radps;
}

std::vector<std::string> warnings_of(const VehicleBinding& binding) {
  std::vector<std::string> warnings;
  for (const BoundMessage& message : binding.messages) {
    const MessageProtection& protection = message.protection;
    if (!protection.has_counter()) {
      warnings.push_back(fmt::format(
          "{}: message {} has no counter, so a sender that repeats an old frame is not noticed",
          binding.dbc_file, message.name));
    }
    if (protection.checksum == ChecksumKind::kNone) {
      warnings.push_back(fmt::format(
          "{}: message {} has no checksum, so a frame that was damaged before it was sent is not "
          "noticed",
          binding.dbc_file, message.name));
    }
  }
  if (!has_fine_steps(binding)) {
    warnings.push_back(fmt::format(
        "{}: wheel speeds in steps of more than {} m/s and a yaw rate in steps of more than {:.2g} "
        "degrees/s repeat while the vehicle drives, so a sensor that is stuck is not noticed",
        binding.dbc_file, kFineSpeed_mps, degrees(kFineYawRate_radps)));
  }
  return warnings;
}

}  // namespace bevloc::can
