#include "firmware/runtime/supervisor.h"

#include <algorithm>
#include <bitset>

namespace bevloc::firmware {
namespace {

/// The frameset rate is averaged over this time.
constexpr Duration kRatePeriod = std::chrono::seconds(1);

}  // namespace

void Supervisor::step(Time now) {
  heartbeat_.beat();
  const EstimationCounters& estimation = appliance_.estimation().counters();
  view_.state = estimation.state;
  view_.why = WhyMask::from_bits(estimation.why);
  view_.lost = estimation.lost;
  view_.lost_why = WhyMask::from_bits(estimation.lost_why);
  view_.cameras = static_cast<int>(std::bitset<kCameraCount>(estimation.cameras).count());
  view_.bus = appliance_.bus().condition();
  const auto& drifts = appliance_.vision().framesets().synchrony().drift_ppm;
  std::ranges::copy(drifts, view_.drift_ppm.begin());
  const VisionCounters& vision = appliance_.vision().counters();
  view_.frozen = CameraMask(vision.frozen);
  view_.dark = CameraMask(vision.dark);
  view_.blinded = CameraMask(vision.blinded);
  view_.dirty = CameraMask(vision.dirty);
  view_.stamp_offset_ms = estimation.stamp_offset_ms;
  view_.gnss_lag_ms = estimation.gnss_lag_ms;
  view_.map_offset_cm = {estimation.map_offset_cm[0], estimation.map_offset_cm[1]};
  view_.calibration_fault = CameraMask(vision.calibration_fault);
  view_.realtime_refusals = realtime_.refusals();
  view_.hung = hung_threads(now);
  update_rate(now);
  notifier_.status(status_text());
}

std::string Supervisor::status_text() const {
  const std::string why = to_string(view_.why);
  std::string text =
      fmt::format("{}{}{}, cameras {}/{}, CAN {}", to_string(view_.state), why.empty() ? "" : ": ",
                  why, view_.cameras, kCameraCount, can::to_string(view_.bus));
  if (!view_.hung.empty()) text += fmt::format(", hangs: {}", view_.hung);
  if (view_.realtime_refusals > 0) {
    text += fmt::format(", {} realtime settings refused", view_.realtime_refusals);
  }
  return text;
}

std::string Supervisor::hung_threads(Time now) {
  std::string hung = watchdog_.hung();
  if (watchdog_watch_.hangs(now)) hung += hung.empty() ? "watchdog" : ", watchdog";
  return hung;
}

void Supervisor::update_rate(Time now) {
  const uint64_t framesets = appliance_.vision().counters().framesets;
  if (rate_since_ == Time::min()) rate_since_ = now;
  if (now - rate_since_ < kRatePeriod) return;
  view_.rate_hz =
      static_cast<double>(framesets - framesets_at_rate_start_) / to_seconds(now - rate_since_);
  rate_since_ = now;
  framesets_at_rate_start_ = framesets;
}

}  // namespace bevloc::firmware
