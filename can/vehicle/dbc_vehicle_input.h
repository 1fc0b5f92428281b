// Decodes odometry and GNSS from the messages of the vehicle's own bus.
#pragma once

#include <optional>
#include <vector>

#include "can/e2e/e2e_monitor.h"
#include "can/messages/message.h"
#include "can/messages/sample_maker.h"
#include "can/vehicle/vehicle_binding.h"

namespace bevloc::can {

/// Makes samples from the signals of a VehicleBinding, as VehicleInput does from bevloc's own
/// messages. Frames must pass counter and checksum (E2eMonitor). An odometry sample is complete
/// when all wheels and the yaw rate have new values. A GNSS sample is complete when all its signals
/// have new values. The time of a sample is that of its earliest value, for GNSS that of the
/// earliest value of the position. The next value will soon replace an old one. So an old value is
/// not combined with the new value of another message: it is dropped, and the sample waits for the
/// next one. Otherwise, after one lost frame, all later samples would combine values of two cycles.
/// A condition (valid, backward) may be at most four cycles of its message old. If its signal is
/// multiplexed, it may be as old as four periods of the signal, but at most 2 s. A GNSS sample does
/// not wait for a heading that is older than that, and then has none. One thread. Does not allocate
/// after construction.
class DbcVehicleInput final : public VehicleDecoder {
 public:
  /// `base` has the identifiers of the localizer's own messages. `rear_track_m` is the distance
  /// between the rear wheels.
  DbcVehicleInput(VehicleBinding binding, const BaseIds& base, GeodeticPosition map_origin,
                  double rear_track_m);

  VehicleSamples accept(const ReceivedFrame& received) override;
  void note_gap() override { maker_.note_gap(); }
  VehicleInputCounters counters() const override;
  VehicleFaultTimes fault_times() const override { return maker_.fault_times(); }

 private:
  /// The latest value of a signal.
  struct Slot {
    double value = 0.0;  ///< in the unit of Quantity
    int64_t raw = 0;
    Time received = Time::min();
    Duration latest_interval{};  ///< between the latest two values
    /// The shorter one of the latest two intervals, because one lost frame makes one of them long.
    /// After two values, it is the only one.
    Duration interval{};
    bool available = false;  ///< whether the value is one of BoundSignal::available
    bool is_new = false;     ///< no sample has used the value yet
  };

  /// Returns whether a value was replaced that no sample had used.
  bool store(size_t message, const ReceivedFrame& received);
  bool all_new(const std::vector<size_t>& signals) const;
  bool drop_stale(const std::vector<size_t>& signals, int frames, Time now);
  bool is_fix_complete(Time now);
  bool waits_for_old(const std::vector<size_t>& signals, size_t message, Time now) const;
  Duration cycle_of(size_t signal) const;
  Duration interval_of(size_t signal) const;
  Duration most_age(size_t signal) const;
  /// Whether the latest value is older than `limit`, or none has come yet.
  bool is_older(size_t signal, Duration limit, Time now) const;
  /// Marks the values as used. Returns whether all are available.
  bool take(const std::vector<size_t>& signals);
  std::optional<bool> holds(const std::optional<BoundCondition>& condition, Time now) const;
  std::optional<OdometrySample> odometry(Time now);
  std::optional<GnssSample> gnss(Time now);
  std::optional<GeodeticFix::Heading> heading(Time now, Time time) const;
  std::optional<double> sigma(const std::optional<size_t>& signal, double stated,
                              double least) const;

  VehicleBinding binding_;
  BaseIds base_;
  double rear_track_m_;
  bool has_fine_steps_;
  SampleMaker maker_;
  std::vector<E2eMonitor> monitors_;
  std::vector<Slot> slots_;
  std::vector<size_t> odometry_signals_;
  std::vector<size_t> position_signals_;  ///< latitude, longitude and their sigmas
  std::vector<size_t> heading_signals_;   ///< the heading and its sigma
  std::vector<size_t> gnss_signals_;      ///< all of these
  int odometry_frames_ = 0;               ///< number of frames that bring a sample of odometry
  int gnss_frames_ = 0;
  VehicleInputCounters counters_;
};

}  // namespace bevloc::can
