// Logs, once per cause, errors that the stages only count.
#pragma once

#include <array>
#include <map>
#include <string>

#include "firmware/status/snapshot.h"
#include "firmware/telemetry/cause_log.h"

namespace bevloc::firmware {

/// Compares snapshots. When an error count grows for the first time in a minute, it logs the cause
/// and what to do. The stages count these errors and write no log line for them. Thread-bound:
/// called from the supervising thread.
class ErrorLog {
 public:
  void note(const Snapshot& snapshot, Time now);

 private:
  struct Count {
    uint64_t seen = 0;
    Time grown = Time::min();  ///< when the count last grew
  };

  /// `text` says what happened and what to do.
  void count(const std::string& text, uint64_t total, Time now);
  void note_camera(int camera, const CameraSnapshot& snapshot, Time now);
  void note_vehicle_input(const can::VehicleInputCounters& input, Time now);
  void note_authentication(const can::SecocCounters& secoc, Time now);
  void note_gnss(const GnssCounters& gnss, Time now);
  void note_tracker(const EstimationSnapshot& estimation, Time now);
  void note_queues(const QueueDrops& drops, Time now);
  void note_bus(const can::BusCounters& bus, Time now);

  std::map<std::string, Count> counts_;  ///< the counts by text
};

}  // namespace bevloc::firmware
