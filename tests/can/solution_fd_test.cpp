#include "can/solution_fd.h"

#include <map>
#include <string>

#include <gtest/gtest.h>

#include "can/mock_bus.h"
#include "can/pose_publisher.h"
#include "tests/can/dbc_parser.h"
#include "tests/can/tracking_report.h"

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;

const Time kNow(milliseconds(5000));

/// With a reason, which LOC_Status has to carry.
PoseReport tracking_report() {
  PoseReport report = test::tracking_report(kNow);
  report.status.why = Why::kGnssMissing;
  return report;
}

std::map<uint32_t, Frame> published(FrameFormat format, const PoseReport& report) {
  MockWire wire;
  const auto sender = wire.connect();
  const auto reader = wire.connect();
  PosePublisher(*sender, {.map_origin = {49.0069, 8.4037}, .format = format}).publish(report, kNow);
  std::map<uint32_t, Frame> frames;
  while (const auto received = reader->receive()) frames[received->frame.id] = received->frame;
  return frames;
}

/// By the DBC file, each signal of the FD frame says what its classic frame says.
void expect_same_content(const PoseReport& report) {
  const test::Dbc dbc = test::load_dbc(std::string(BEVLOC_SOURCE_DIR) + "/can/bevloc.dbc");
  const test::DbcMessage& solution = dbc.message("LOC_Solution");
  const auto fd = published(FrameFormat::kFd, report);
  ASSERT_EQ(fd.size(), 1u);
  const Frame& joined = fd.at(solution.id);
  EXPECT_EQ(joined.format, FrameFormat::kFd);
  size_t signals = 0;
  for (const auto& [id, frame] : published(FrameFormat::kClassic, report)) {
    for (const test::DbcSignal& signal : dbc.messages.at(id).signals) {
      if (signal.start_bit < 16) continue;
      EXPECT_EQ(solution.signal(signal.name).raw_from(joined.payload()),
                signal.raw_from(frame.payload()))
          << signal.name;
      ++signals;
    }
  }
  constexpr size_t kHeaderSignals = 2;
  EXPECT_EQ(signals, solution.signals.size() - kHeaderSignals);
}

TEST(SolutionFd, SaysWhatTheClassicFramesSay) {
  expect_same_content(tracking_report());
}

TEST(SolutionFd, SaysThatNothingIsAvailableAsTheClassicFramesDo) {
  expect_same_content(PoseReport{});
  PoseReport stale = tracking_report();
  stale.pose_time = kNow - milliseconds(500);
  expect_same_content(stale);
}

TEST(SolutionFd, PartsIntoWhatItWasJoinedFrom) {
  const BaseIds base;
  PoseReport report = tracking_report();
  GeoReference geo({49.0, 8.4});
  const LocalizerStatus told = told_status(report, {}, kNow);
  const Frame status = status_frame(told, base);
  const SolutionFrames frames = solution_frames(report, told, {}, geo, base, kNow);
  const Frame joined = joined_solution(status, frames, base);
  EXPECT_EQ(part_of_solution(joined, 0, base), status);
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(part_of_solution(joined, i + 1, base), frames[i]);
  }
}

TEST(SolutionFd, APublisherNamesTheIdsThatItSends) {
  for (const FrameFormat format : {FrameFormat::kClassic, FrameFormat::kFd}) {
    const auto ids = PosePublisher::sent_ids(BaseIds{}, format);
    const auto frames = published(format, tracking_report());
    EXPECT_EQ(ids.size(), frames.size());
    for (const uint32_t id : ids) EXPECT_TRUE(frames.contains(id)) << id;
  }
}

}  // namespace
}  // namespace bevloc::can
