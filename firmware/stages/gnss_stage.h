// The GNSS stage: takes positions from gpsd and queues them as samples.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "can/messages/sample_maker.h"
#include "common/published.h"
#include "drivers/clock/clock.h"
#include "drivers/gnss/fix_clock.h"
#include "drivers/gnss/gpsd_client.h"
#include "firmware/config/gnss_config.h"
#include "firmware/stages/messages.h"

namespace bevloc::firmware {

/// Totals since start, and the latest state.
struct GnssCounters {
  drivers::GpsdCounters gpsd;
  std::array<uint64_t, drivers::kFixVerdicts> fixes{};  ///< number of fixes for each FixVerdict
  uint64_t samples = 0;
  bool connected = false;
  Duration max_age{};  ///< largest age of a fix that was used

  uint64_t of(drivers::GpsdLine line) const { return gpsd.of(line); }
  uint64_t of(drivers::FixVerdict verdict) const { return fixes[static_cast<size_t>(verdict)]; }
};

/// Thread-bound: called from the GNSS thread. counters() is readable from any thread.
class GnssStage {
 public:
  using ReadWall = drivers::WallTime (*)();
  using Observer = std::function<void(const drivers::GnssFix& fix, const drivers::FixTime& time)>;

  /// `clock` and `samples` must outlive the stage.
  GnssStage(const GnssConfig& config, can::GeodeticPosition map_origin, const drivers::Clock& clock,
            VehicleQueue& samples, ReadWall read_wall = drivers::read_wall_time);

  /// Waits for reports of gpsd, at most `timeout` of real time, and queues their samples.
  void step(Duration timeout);

  /// Queues the sample of a fix whose time is known. A replay gives the recorded fixes to it
  /// instead of calling step().
  void take(const drivers::GnssFix& fix, const drivers::FixTime& time);

  /// Sets a function that is called with each fix that is used. It is called in the thread of the
  /// stage. Call this before the first step().
  void observe(Observer observer) { observer_ = std::move(observer); }

  GnssCounters counters() const { return published_.load(); }

 private:
  void judge(const drivers::GnssFix& fix, const drivers::FixArrival& arrival);

  const GnssConfig config_;
  can::GeoReference geo_;
  const drivers::Clock& clock_;
  VehicleQueue& samples_;
  const ReadWall read_wall_;
  drivers::GpsdClient client_;
  drivers::FixClock fix_clock_;
  Observer observer_;
  GnssCounters counters_;
  Published<GnssCounters> published_;
};

/// Returns the sample of a fix with the time `time`. The uncertainty of the time, multiplied by the
/// speed, adds to that of the position. From 5 m/s on, the course counts as the heading, because no
/// vehicle reverses so fast.
GnssSample gnss_sample_of(const drivers::GnssFix& fix, const drivers::FixTime& time,
                          const GnssConfig& config, can::GeoReference& geo);

}  // namespace bevloc::firmware
