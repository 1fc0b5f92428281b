#include "can/publisher/solution_fd.h"

#include <map>
#include <string>

#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "can/publisher/pose_publisher.h"
#include "tests/can/messages/dbc_parser.h"
#include "tests/can/messages/tracking_report.h"

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;
using test::kNow;

/// A report with a Why bit in LOC_Status and one in LOC_Integrity.
PoseReport report_with_reason() {
  PoseReport report = test::tracking_report(kNow);
  report.status.why = Why::kGnssMissing | Why::kClockGap;
  return report;
}

std::map<uint32_t, Frame> published(FrameFormat format, const PoseReport& report) {
  MockWire wire;
  const auto sender = wire.connect();
  const auto reader = wire.connect();
  PosePublisher(*sender, {.map_origin = test::kOrigin, .format = format}).publish(report, kNow);
  std::map<uint32_t, Frame> frames;
  while (const auto received = reader->receive()) frames[received->frame.id] = received->frame;
  return frames;
}

/// Expects, with the DBC file, that each signal has the same value in the FD frame and in its
/// classic frame.
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

TEST(SolutionFd, HasTheContentOfTheClassicFrames) {
  expect_same_content(report_with_reason());
}

TEST(SolutionFd, HasSnaWhereTheClassicFramesHaveSna) {
  expect_same_content(PoseReport{});
  PoseReport stale = report_with_reason();
  stale.pose_time = kNow - milliseconds(500);
  expect_same_content(stale);
}

TEST(SolutionFd, SplittingReturnsTheJoinedFrames) {
  const BaseIds base;
  PoseReport report = report_with_reason();
  GeoReference geo({49.0, 8.4});
  const LocalizerStatus status = status_to_send(report, kNow);
  const Frame first = status_frame(status, base);
  const SolutionFrames frames = solution_frames(report, status, geo, base, kNow);
  const Frame identity = identity_frame({.model = 0xDEADBEEF}, 2, base);
  const Frame joined = joined_solution(first, frames, identity, base);
  EXPECT_EQ(part_of_solution(joined, 0, base), first);
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(part_of_solution(joined, i + 1, base), frames[i]);
  }
  EXPECT_EQ(part_of_solution(joined, frames.size() + 1, base), identity);
}

TEST(SolutionFd, APublisherListsTheIdentifiersThatItSends) {
  for (const FrameFormat format : {FrameFormat::kClassic, FrameFormat::kFd}) {
    const auto ids = PosePublisher::sent_ids(BaseIds{}, format, false, false);
    const auto frames = published(format, report_with_reason());
    EXPECT_EQ(ids.size(), frames.size());
    for (const uint32_t id : ids) EXPECT_TRUE(frames.contains(id)) << id;
    auto with_clock = PosePublisher::sent_ids(BaseIds{}, format, false, true);
    EXPECT_EQ(with_clock.size(), ids.size() + 1);
    EXPECT_EQ(with_clock.back(), loc_clock::kMessage.id(BaseIds{}));
  }
}

}  // namespace
}  // namespace bevloc::can
