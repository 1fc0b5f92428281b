#include "evaluation/recording/replay.h"

#include "can/bus/candump.h"
#include "common/image_view.h"
#include "evaluation/drive/bus_log.h"
#include "firmware/runtime/runner.h"

namespace bevloc::evaluation {
namespace {

constexpr Duration kBusCycle = std::chrono::milliseconds(10);
constexpr const char* kInterface = "can0";

std::string describe(const PlayedFrame& frame) {
  return can::candump_line(frame.frame.received.time_since_epoch(), kInterface, frame.frame.frame,
                           can::CandumpDigits::kNanoseconds);
}

bool same(const PlayedFrame& a, const PlayedFrame& b) {
  return a.frame.frame == b.frame.frame && a.frame.received == b.frame.received;
}

/// Gives each position of gpsd to the appliance at the time when it got it in the drive. Positions
/// are left out if the appliance takes those of the bus.
firmware::Companion gpsd_of(const std::vector<firmware::RecordedFix>& fixes,
                            firmware::GnssStage* gnss) {
  const auto give = [&fixes, gnss, next = size_t{0}](Time now) mutable {
    for (; gnss != nullptr && next < fixes.size() && fixes[next].time <= now; ++next) {
      gnss->take(fixes[next].fix, fixes[next].held);
    }
  };
  return {.next_due = {}, .act = give, .listen = [](Duration) {}};
}

}  // namespace

Result<ReplayOutcome> replay(const ReplaySetup& setup, const ReplayInputs& inputs,
                             const std::filesystem::path& can_log) {
  auto log = BusLog::create(can_log);
  if (!log) return tl::unexpected(log.error());
  drivers::VirtualClock clock(inputs.begin);
  ReplayOutcome outcome;
  const auto seen = [&](const can::Frame& frame, Time time, bool sent) {
    log->add(time - inputs.begin, frame);
    if (sent) outcome.sent.push_back({time, {frame, time}});
  };
  firmware::Hardware hardware{inputs.cameras(clock),
                              std::make_unique<PlayedBus>(inputs.bus, clock, seen), &clock};
  auto appliance =
      firmware::Appliance::create(setup.config, setup.rig, setup.map, std::move(hardware));
  if (!appliance) return tl::unexpected(appliance.error());
  (*appliance)->estimation().observe_reports([&outcome](const can::PoseReport& report) {
    ReplayedPose pose{report.pose_time, report.status.state, std::nullopt};
    if (report.map_from_vehicle.is_finite()) pose.map_from_vehicle = report.map_from_vehicle;
    outcome.poses.push_back(pose);
  });
  const firmware::Companion gpsd = gpsd_of(inputs.fixes, (*appliance)->gnss());
  // The recorded run ended one cycle before its last frame, which says LOST.
  firmware::run_lockstep(**appliance, clock, &gpsd,
                         [&](Time now) { return now + kBusCycle < inputs.end; });
  outcome.framesets = (*appliance)->vision().counters().framesets;
  if (Status status = log->finish(); !status) return tl::unexpected(status.error());
  return outcome;
}

BusComparison compare_bus(const std::vector<PlayedFrame>& recorded,
                          const std::vector<PlayedFrame>& replayed) {
  BusComparison comparison{recorded.size(), replayed.size(), 0, std::nullopt};
  const size_t shared = std::min(recorded.size(), replayed.size());
  while (comparison.equal < shared &&
         same(recorded[comparison.equal], replayed[comparison.equal])) {
    ++comparison.equal;
  }
  if (comparison.equal < shared) {
    comparison.different =
        fmt::format("recorded {}, replayed {}", describe(recorded[comparison.equal]),
                    describe(replayed[comparison.equal]));
  }
  return comparison;
}

std::string bus_text(const BusComparison& bus, bool in_real_time) {
  if (!bus.different && bus.recorded == bus.replayed) {
    return fmt::format("bus       {} frames, equal to the recorded ones byte for byte\n",
                       bus.replayed);
  }
  std::string text = fmt::format("bus       {} frames, {} were recorded; the first {} are equal\n",
                                 bus.replayed, bus.recorded, bus.equal);
  if (bus.different) text += fmt::format("          first difference: {}\n", *bus.different);
  if (in_real_time) {
    text += "          The recorded drive ran in real time, so the replay sends other frames.\n";
  }
  return text;
}

}  // namespace bevloc::evaluation
