#include "firmware/view_log.h"

#include <cmath>

#include <spdlog/spdlog.h>

namespace bevloc::firmware {

void ViewLog::note(const ApplianceView& view) {
  if (view.state != before_.state) {
    spdlog::info("{} -> {} ({})", to_string(before_.state), to_string(view.state),
                 to_string(view.why));
  }
  if (view.bus != before_.bus) {
    spdlog::warn("CAN {} -> {}", can::to_string(before_.bus), can::to_string(view.bus));
  }
  note_drifts(view);
  note_frozen(view.frozen);
  before_ = view;
}

void ViewLog::note_drifts(const ApplianceView& view) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const double ppm = view.drift_ppm[camera];
    const double before_ppm = before_.drift_ppm[camera];
    if (ppm != 0.0 && before_ppm == 0.0) {
      spdlog::warn("camera {}: its clock is {:.0f} ppm too {}, against the median camera",
                   kCameraNames[camera], std::abs(ppm), ppm > 0.0 ? "fast" : "slow");
    } else if (ppm == 0.0 && before_ppm != 0.0) {
      spdlog::info("camera {}: drifts no more", kCameraNames[camera]);
    }
  }
}

void ViewLog::note_frozen(CameraMask frozen) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (frozen[camera] == before_.frozen[camera]) continue;
    if (frozen[camera]) {
      spdlog::warn("camera {}: its picture stands still", kCameraNames[camera]);
    } else {
      spdlog::info("camera {}: its picture changes again", kCameraNames[camera]);
    }
  }
}

void log_synchrony(const SynchronyCounters& synchrony, const drivers::Trigger* trigger) {
  spdlog::info("frames of one set: {:.3f} ms apart at most",
               1e3 * to_seconds(synchrony.spread_max));
  if (trigger == nullptr) return;
  const drivers::TriggerCounters& counters = trigger->counters();
  spdlog::info(
      "trigger: {} pulses, {:.3f} ms late at most, {} skipped, {} refused by the line; {} sets "
      "without a pulse",
      trigger->pulses().count(), 1e3 * to_seconds(counters.latest_by), counters.skipped,
      counters.failed, synchrony.off_pulse);
}

}  // namespace bevloc::firmware
