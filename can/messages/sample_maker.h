// Makes samples from decoded odometry and GNSS, and remembers when they were wrong.
#pragma once

#include <optional>

#include "can/e2e/e2e_monitor.h"
#include "can/messages/geo_reference.h"
#include "can/messages/message.h"
#include "can/messages/odometry_check.h"
#include "can/messages/vehicle_decoder.h"

namespace bevloc::can {

/// A position of the middle of the rear axle on the ground. Each sigma is one standard deviation.
struct GeodeticFix {
  struct Heading {
    double heading_deg = 0.0;  ///< clockwise from true north
    double sigma_deg = 0.0;
  };

  GeodeticPosition position;
  double sigma_north_m = 0.0;
  double sigma_east_m = 0.0;
  std::optional<Heading> heading{};  ///< empty when the receiver has no heading
};

/// Returns the fix in the map frame.
GnssSample gnss_sample_of(const GeodeticFix& fix, GeoReference& geo, Time time);

/// Makes samples of odometry and GNSS for the implementations of VehicleDecoder. Does not allocate
/// after construction. One thread.
class SampleMaker {
 public:
  /// `rear_track_m` is the distance between the rear wheels. Odometry comes every
  /// `odometry_interval`.
  SampleMaker(GeodeticPosition map_origin, double rear_track_m, Duration odometry_interval)
      : geo_(map_origin), odometry_check_(rear_track_m, odometry_interval) {}

  /// Call it first for each frame, with its time of arrival.
  void note_frame(Time received) { latest_ = received; }
  /// OdometryCheck::note_gap().
  void note_gap() { odometry_check_.note_gap(); }
  void note_implausible() { fault_times_.implausible = latest_; }
  /// Notes a frame that has none of the vehicle's messages.
  void note_unknown(const Frame& frame, const BaseIds& base);
  /// Gives the latest frame to the monitor of its message, and notes what the monitor finds.
  /// Returns whether the frame can be used.
  bool accept(E2eMonitor& monitor, const E2eFrame& frame, bool has_odometry);

  /// Returns nothing if the wheels are not plausible.
  std::optional<OdometrySample> odometry(const OdometryCheck::Wheels& wheels);
  GnssSample gnss(const GeodeticFix& fix, Time time);

  const VehicleFaultTimes& fault_times() const { return fault_times_; }
  /// Adds what this class counted: unknown frames, and the samples that it made or refused.
  void add_to(VehicleInputCounters& counters) const;

 private:
  GeoReference geo_;
  OdometryCheck odometry_check_;
  uint64_t own_ids_ = 0;
  uint64_t foreign_frames_ = 0;
  uint64_t odometry_samples_ = 0;
  uint64_t slow_samples_ = 0;
  uint64_t gnss_samples_ = 0;
  Time latest_{};  ///< when the latest frame arrived
  VehicleFaultTimes fault_times_;
};

}  // namespace bevloc::can
