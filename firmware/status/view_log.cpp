#include "firmware/status/view_log.h"

#include <cstdlib>

#include <spdlog/spdlog.h>

namespace bevloc::firmware {

void ViewLog::note(const ApplianceView& view, Time now) {
  // The state LOST lasts one bus cycle, and most views are taken before or after it.
  if (view.lost != before_.lost) spdlog::warn("pose lost: {}", to_string(view.lost_why));
  note_state(view, now);
  if (const auto change =
          bus_conditions_.note(can::to_string(view.bus), "", ChangeKind::kMayAlternate, now)) {
    spdlog::warn("CAN {}", *change);
  }
  if (view.hung != before_.hung) {
    if (view.hung.empty()) {
      spdlog::info("every thread makes progress again");
    } else {
      spdlog::error("no progress in thread {}; systemd restarts bevlocd if it lasts", view.hung);
    }
  }
  note_drifts(view);
  note_cameras(before_.frozen, view.frozen, "frozen, repeats images while the vehicle drives",
               "power-cycle the camera and check its lens");
  note_cameras(before_.dark, view.dark, "dark, its image is black and without contrast",
               "check its lens, exposure and cable");
  note_cameras(before_.blinded, view.blinded, "blinded, a large part of its image is white",
               "check its exposure if no bright light explains this");
  note_cameras(before_.dirty, view.dirty, "dirty, parts of its image do not move while driving",
               "clean the lens");
  note_stamps(view.stamp_offset_ms);
  note_gnss_lag(view.gnss_lag_ms);
  note_map_offset(view.map_offset_cm);
  note_cameras(
      before_.calibration_fault, view.calibration_fault,
      "out of place, it is not where the calibration says",
      "check its mount and whether it is connected in another camera's place, then calibrate");
  before_ = view;
}

void ViewLog::note_state(const ApplianceView& view, Time now) {
  const bool may_alternate = claims_pose(before_.state) && claims_pose(view.state);
  const auto change =
      states_.note(to_string(view.state), to_string(view.why),
                   may_alternate ? ChangeKind::kMayAlternate : ChangeKind::kImportant, now);
  if (change) spdlog::info("state {}", *change);
}

void ViewLog::note_drifts(const ApplianceView& view) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const double ppm = view.drift_ppm[camera];
    const double before_ppm = before_.drift_ppm[camera];
    if (ppm != 0.0 && before_ppm == 0.0) {
      spdlog::warn(
          "camera {}: drift of {:+.0f} ppm against the median camera; use a trigger, or "
          "compensate_motion with a wide tolerance_ms",
          kCameraNames[camera], ppm);
    } else if (ppm == 0.0 && before_ppm != 0.0) {
      spdlog::info("camera {}: no drift any more", kCameraNames[camera]);
    }
  }
}

void ViewLog::note_stamps(int offset_ms) const {
  if ((offset_ms != 0) == (before_.stamp_offset_ms != 0)) return;
  if (offset_ms != 0) {
    spdlog::warn(
        "cameras: their time stamps are {} ms too {} against the yaw rate, as bends show; check "
        "the clock of the cameras and the delay of the yaw rate",
        std::abs(offset_ms), offset_ms > 0 ? "late" : "early");
  } else {
    spdlog::info("cameras: their time stamps agree with the yaw rate again");
  }
}

void ViewLog::note_gnss_lag(int lag_ms) const {
  if ((lag_ms != 0) == (before_.gnss_lag_ms != 0)) return;
  if (lag_ms != 0) {
    spdlog::error(
        "GNSS: its headings are {} ms older than the yaw rate, as bends show; check the delay of "
        "its messages",
        lag_ms);
  } else {
    spdlog::info("GNSS: its headings agree with odometry again, or it is not used");
  }
}

void ViewLog::note_map_offset(const std::array<int, 2>& offset_cm) const {
  constexpr std::array<int, 2> kNone{};
  if ((offset_cm != kNone) == (before_.map_offset_cm != kNone)) return;
  if (offset_cm != kNone) {
    spdlog::error(
        "map: it lies off GNSS by {:.1f} m to the east and {:.1f} m to the north all the time; "
        "check the map's datum and origin and the place of the GNSS antenna",
        -0.01 * offset_cm[0], -0.01 * offset_cm[1]);
  } else {
    spdlog::info("map: it agrees with GNSS again");
  }
}

void ViewLog::note_cameras(CameraMask before, CameraMask now, std::string_view what,
                           std::string_view advice) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (now[camera] == before[camera]) continue;
    if (now[camera]) {
      spdlog::warn("camera {}: {}; {}", kCameraNames[camera], what, advice);
    } else {
      // Images are judged only when a frameset is matched.
      spdlog::info("camera {}: no longer {}, or its images are not judged now",
                   kCameraNames[camera], what.substr(0, what.find(',')));
    }
  }
}

}  // namespace bevloc::firmware
