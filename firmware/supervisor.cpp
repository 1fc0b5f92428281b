#include "firmware/supervisor.h"

#include <bitset>

namespace bevloc::firmware {
namespace {

constexpr Duration kRatePeriod = std::chrono::seconds(1);

}  // namespace

void Supervisor::step(Time now) {
  const EstimationCounters& estimation = appliance_.estimation().counters();
  const VisionCounters& vision = appliance_.vision().counters();
  view_.state = estimation.state;
  view_.why = can::WhyMask::from_bits(estimation.why);
  view_.cameras = static_cast<int>(std::bitset<kCameraCount>(estimation.cameras).count());
  update_rate(now);

  if (!ready_) {
    notifier_.ready();
    ready_ = true;
  }
  const std::string why = to_string(view_.why);
  notifier_.status(fmt::format("{}{}{}, cameras {}/{}", to_string(view_.state),
                               why.empty() ? "" : ": ", why, view_.cameras, kCameraCount));
  if (estimation.ticks != last_ticks_ && vision.steps != last_steps_) {
    notifier_.feed_watchdog();
    last_ticks_ = estimation.ticks;
    last_steps_ = vision.steps;
  }
}

void Supervisor::update_rate(Time now) {
  const uint64_t framesets = appliance_.vision().counters().framesets;
  if (rate_since_ == Time::min()) rate_since_ = now;
  if (now - rate_since_ < kRatePeriod) return;
  view_.rate_hz = static_cast<double>(framesets - framesets_then_) / to_seconds(now - rate_since_);
  rate_since_ = now;
  framesets_then_ = framesets;
}

}  // namespace bevloc::firmware
