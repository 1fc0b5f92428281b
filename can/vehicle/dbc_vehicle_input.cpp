#include "can/vehicle/dbc_vehicle_input.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "can/vehicle/wheel_fusion.h"
#include "common/geodetic.h"

namespace bevloc::can {
namespace {

constexpr int kMostCycles = 4;
/// A multiplexed signal may come seldom. A value is not used longer than this, unless the message
/// itself comes so seldom.
constexpr Duration kMostAgeOfSeldom = std::chrono::seconds(2);
/// If n frames come once per interval, the longest gap between two of them is at least the interval
/// divided by n. A sample begins after such a gap. Frames do not come exactly on time, so this
/// share of the gap suffices.
constexpr double kGapShare = 0.8;
/// The smallest sigmas, because no measurement is exact. A signal with coarse steps shows a sigma
/// of less than one step as 0.
constexpr double kLeastSigma_m = 0.01;
constexpr double kLeastSigma_deg = 0.01;

E2eReceiverParameters parameters_of(const BoundMessage& message) {
  if (!message.has_odometry) return gnss_receiver_parameters(message.cycle);
  return {.cycle = message.cycle};
}

void add_if(std::vector<size_t>& signals, const std::optional<size_t>& signal) {
  if (signal && std::ranges::find(signals, *signal) == signals.end()) signals.push_back(*signal);
}

/// Returns the number of frames that bring these signals.
int frames_of(const VehicleBinding& binding, const std::vector<size_t>& signals) {
  std::set<std::pair<size_t, std::optional<uint64_t>>> frames;
  for (const size_t index : signals) {
    const BoundSignal& signal = binding.signals[index];
    std::optional<uint64_t> page;
    if (signal.multiplexed) page = signal.multiplexed->value;
    frames.emplace(signal.message, page);
  }
  return static_cast<int>(frames.size());
}

}  // namespace

DbcVehicleInput::DbcVehicleInput(VehicleBinding binding, const BaseIds& base,
                                 GeodeticPosition map_origin, double rear_track_m)
    : binding_(std::move(binding)),
      base_(base),
      rear_track_m_(rear_track_m),
      has_fine_steps_(has_fine_steps(binding_)),
      maker_(map_origin, rear_track_m, odometry_interval(binding_)),
      slots_(binding_.signals.size()) {
  for (const BoundMessage& message : binding_.messages) {
    const MessageProtection& protection = message.protection;
    const uint8_t highest =
        protection.checksum == ChecksumKind::kE2eP05 ? UINT8_MAX : protection.highest_counter;
    monitors_.emplace_back(highest, parameters_of(message));
  }
  for (const BoundWheels::Wheel& wheel : binding_.wheels.wheels) {
    odometry_signals_.push_back(wheel.signal);
  }
  odometry_signals_.push_back(binding_.yaw_rate.signal);
  odometry_frames_ = frames_of(binding_, odometry_signals_);
  if (!binding_.gnss) return;
  const BoundGnss& gnss = *binding_.gnss;
  position_signals_ = {gnss.latitude, gnss.longitude};
  for (const auto& signal : {gnss.sigma_north, gnss.sigma_east}) add_if(position_signals_, signal);
  for (const auto& signal : {gnss.heading, gnss.sigma_heading}) add_if(heading_signals_, signal);
  gnss_signals_ = position_signals_;
  gnss_signals_.insert(gnss_signals_.end(), heading_signals_.begin(), heading_signals_.end());
  gnss_frames_ = frames_of(binding_, gnss_signals_);
}

VehicleSamples DbcVehicleInput::accept(const ReceivedFrame& received) {
  maker_.note_frame(received.received);
  const auto message = std::ranges::find(binding_.messages, received.frame.id, &BoundMessage::id);
  if (message == binding_.messages.end()) {
    maker_.note_unknown(received.frame, base_);
    return {};
  }
  const auto index = static_cast<size_t>(message - binding_.messages.begin());
  const E2eFrame checked = e2e_frame_of(received.frame, message->protection, message->length);
  if (!maker_.accept(monitors_[index], checked, message->has_odometry)) return {};
  const bool replaced_unused = store(index, received);
  VehicleSamples samples;
  const bool has_odometry = all_new(odometry_signals_) &&
                            !drop_stale(odometry_signals_, odometry_frames_, received.received);
  if (has_odometry) samples.odometry = odometry(received.received);
  if (is_fix_complete(received.received)) samples.gnss = gnss(received.received);
  if (replaced_unused && (waits_for_old(odometry_signals_, index, received.received) ||
                          waits_for_old(position_signals_, index, received.received))) {
    ++counters_.incomplete;
  }
  return samples;
}

/// Whether there is a new position, and no heading must be waited for.
bool DbcVehicleInput::is_fix_complete(Time now) {
  if (position_signals_.empty() || !all_new(position_signals_)) return false;
  const bool heading_stopped = std::ranges::any_of(
      heading_signals_, [&](size_t signal) { return is_older(signal, most_age(signal), now); });
  if (heading_stopped) return !drop_stale(position_signals_, gnss_frames_, now);
  return all_new(heading_signals_) && !drop_stale(gnss_signals_, gnss_frames_, now);
}

/// Whether `message` has one of these signals, while another one of them no longer comes.
bool DbcVehicleInput::waits_for_old(const std::vector<size_t>& signals, size_t message,
                                    Time now) const {
  const auto is_of_message = [&](size_t signal) {
    return binding_.signals[signal].message == message;
  };
  return std::ranges::any_of(signals, is_of_message) &&
         std::ranges::any_of(
             signals, [&](size_t signal) { return is_older(signal, most_age(signal), now); });
}

bool DbcVehicleInput::store(size_t message, const ReceivedFrame& received) {
  bool replaced_unused = false;
  const std::span<const uint8_t> bytes = received.frame.payload();
  for (size_t i = 0; i < slots_.size(); ++i) {
    const BoundSignal& signal = binding_.signals[i];
    if (signal.message != message) continue;
    const bool is_absent = signal.multiplexed && raw_bits_from(signal.multiplexed->multiplexor,
                                                               bytes) != signal.multiplexed->value;
    if (is_absent) continue;
    const double physical = physical_from(signal.layout, bytes);
    Slot& slot = slots_[i];
    replaced_unused = replaced_unused || slot.is_new;
    if (slot.received != Time::min()) {
      const Duration interval = received.received - slot.received;
      const bool is_first = slot.latest_interval == Duration::zero();
      slot.interval = is_first ? interval : std::min(interval, slot.latest_interval);
      slot.latest_interval = interval;
    }
    slot.raw = raw_from(signal.layout, bytes);
    slot.value = physical * signal.factor;
    slot.received = received.received;
    slot.is_new = true;
    slot.available = signal.available.has(slot.raw, physical);
  }
  return replaced_unused;
}

bool DbcVehicleInput::all_new(const std::vector<size_t>& signals) const {
  return std::ranges::all_of(signals, [this](size_t signal) { return slots_[signal].is_new; });
}

/// Drops each value that is so old that its message comes again soon. The sample then waits for
/// that message. Returns whether a value was dropped.
bool DbcVehicleInput::drop_stale(const std::vector<size_t>& signals, int frames, Time now) {
  Duration longest{};
  for (const size_t signal : signals) longest = std::max(longest, interval_of(signal));
  const double fresh_share = 1.0 - kGapShare / frames;
  bool dropped = false;
  bool sample_is_lost = false;
  for (const size_t signal : signals) {
    const Duration interval = interval_of(signal);
    const Duration fresh = from_seconds(fresh_share * to_seconds(interval));
    if (!is_older(signal, std::min(fresh, most_age(signal)), now)) continue;
    slots_[signal].is_new = false;
    dropped = true;
    // A message that comes more often than the others brings the next value for the same sample.
    sample_is_lost = sample_is_lost || 2 * interval > longest;
  }
  if (sample_is_lost) ++counters_.incomplete;
  return dropped;
}

bool DbcVehicleInput::take(const std::vector<size_t>& signals) {
  bool available = true;
  for (const size_t signal : signals) {
    slots_[signal].is_new = false;
    available = available && slots_[signal].available;
  }
  if (!available) ++counters_.not_available;
  return available;
}

Duration DbcVehicleInput::cycle_of(size_t signal) const {
  return binding_.messages[binding_.signals[signal].message].cycle;
}

/// The time between two values of the signal. A multiplexed signal comes less often than its
/// message.
Duration DbcVehicleInput::interval_of(size_t signal) const {
  return std::max(cycle_of(signal), slots_[signal].interval);
}

/// The largest age of a value that is used: four cycles of its message. If the signal is
/// multiplexed, it is four intervals of the signal, but at most kMostAgeOfSeldom.
Duration DbcVehicleInput::most_age(size_t signal) const {
  const Duration by_message = kMostCycles * cycle_of(signal);
  if (!binding_.signals[signal].multiplexed) return by_message;
  return std::max(by_message, std::min(kMostCycles * interval_of(signal), kMostAgeOfSeldom));
}

bool DbcVehicleInput::is_older(size_t signal, Duration limit, Time now) const {
  const Time received = slots_[signal].received;
  return received == Time::min() || now - received > limit;
}

/// Returns nothing if the signal of the condition is missing, too old or not available. An empty
/// condition always holds.
std::optional<bool> DbcVehicleInput::holds(const std::optional<BoundCondition>& condition,
                                           Time now) const {
  if (!condition) return true;
  if (is_older(condition->signal, most_age(condition->signal), now)) return std::nullopt;
  const Slot& slot = slots_[condition->signal];
  if (std::ranges::find(condition->values, slot.raw) != condition->values.end()) return true;
  return slot.available ? std::optional(false) : std::nullopt;
}

std::optional<OdometrySample> DbcVehicleInput::odometry(Time now) {
  if (!take(odometry_signals_)) return std::nullopt;
  const BoundYawRate& turning = binding_.yaw_rate;
  const BoundWheels& moving = binding_.wheels;
  const auto negative = turning.negative ? holds(turning.negative, now) : std::optional(false);
  const auto backward = moving.backward ? holds(moving.backward, now) : std::optional(false);
  const bool valid =
      holds(turning.valid, now).value_or(false) && holds(moving.valid, now).value_or(false);
  if (!valid || !negative || !backward) {
    ++counters_.not_available;
    return std::nullopt;
  }
  double yaw_rate_radps = slots_[turning.signal].value;
  // A signal with a condition may have a sign of its own. abs() makes a second minus harmless.
  if (*negative) yaw_rate_radps = -std::abs(yaw_rate_radps);
  if (turning.positive_right) yaw_rate_radps = -yaw_rate_radps;
  WheelFusion fusion(rear_track_m_, moving.wheelbase_m, yaw_rate_radps);
  for (const BoundWheels::Wheel& wheel : moving.wheels) {
    const double speed_mps = slots_[wheel.signal].value;
    fusion.add(wheel.place, *backward ? -std::abs(speed_mps) : speed_mps);
  }
  const auto speeds = fusion.speeds();
  if (!speeds) {
    ++counters_.contradicting_wheels;
    maker_.note_implausible();
    return std::nullopt;
  }
  Time first = now;
  for (const size_t signal : odometry_signals_) first = std::min(first, slots_[signal].received);
  auto sample = maker_.odometry({.time = first,
                                 .left_mps = speeds->left_mps,
                                 .right_mps = speeds->right_mps,
                                 .yaw_rate_radps = yaw_rate_radps,
                                 .both_sides = speeds->both_sides});
  if (sample) sample->has_fine_steps = has_fine_steps_;
  return sample;
}

/// Returns the value of the signal, or `stated` if there is no signal. It is at least `least` and
/// one step of the signal. Returns nothing if it is negative, because then it is no sigma.
std::optional<double> DbcVehicleInput::sigma(const std::optional<size_t>& signal, double stated,
                                             double least) const {
  if (!signal) return std::max(least, stated);
  const double value = slots_[*signal].value;
  if (value < 0.0) return std::nullopt;
  return std::max({least, step_of(binding_.signals[*signal]), value});
}

/// Returns nothing if there is no valid heading, if it has stopped, or if it came too long before
/// or after `time`.
std::optional<GeodeticFix::Heading> DbcVehicleInput::heading(Time now, Time time) const {
  const BoundGnss& gnss = *binding_.gnss;
  if (!gnss.heading || !holds(gnss.heading_valid, now).value_or(false)) return std::nullopt;
  const auto is_usable = [&](size_t signal) {
    const Slot& slot = slots_[signal];
    return slot.available && !is_older(signal, most_age(signal), now) &&
           std::chrono::abs(slot.received - time) <= most_age(signal);
  };
  if (gnss.sigma_heading && !is_usable(*gnss.sigma_heading)) return std::nullopt;
  const auto sigma_deg = sigma(gnss.sigma_heading, gnss.sigma_heading_deg, kLeastSigma_deg);
  if (!sigma_deg || !is_usable(*gnss.heading)) return std::nullopt;
  return GeodeticFix::Heading{slots_[*gnss.heading].value, *sigma_deg};
}

std::optional<GnssSample> DbcVehicleInput::gnss(Time now) {
  const BoundGnss& gnss = *binding_.gnss;
  const bool available = take(position_signals_);
  for (const size_t signal : heading_signals_) slots_[signal].is_new = false;
  if (!available) return std::nullopt;
  if (!holds(gnss.valid, now).value_or(false)) {
    ++counters_.not_available;
    return std::nullopt;
  }
  const GeodeticPosition position = {slots_[gnss.latitude].value, slots_[gnss.longitude].value};
  const auto sigma_north_m = sigma(gnss.sigma_north, gnss.sigma_m, kLeastSigma_m);
  const auto sigma_east_m = sigma(gnss.sigma_east, gnss.sigma_m, kLeastSigma_m);
  if (!is_on_earth(position.latitude_deg, position.longitude_deg) || !sigma_north_m ||
      !sigma_east_m) {
    ++counters_.not_available;
    return std::nullopt;
  }
  GeodeticFix fix{
      .position = position, .sigma_north_m = *sigma_north_m, .sigma_east_m = *sigma_east_m};
  const Time time = std::min(slots_[gnss.latitude].received, slots_[gnss.longitude].received);
  fix.heading = heading(now, time);
  return maker_.gnss(fix, time);
}

VehicleInputCounters DbcVehicleInput::counters() const {
  VehicleInputCounters total = counters_;
  for (const E2eMonitor& monitor : monitors_) total.add(monitor.counters());
  maker_.add_to(total);
  return total;
}

}  // namespace bevloc::can
