// Reports of recordings with damaged pictures and gaps.
#include <regex>

#include <gmock/gmock.h>

#include "common/files.h"
#include "common/jpeg.h"
#include "evaluation/report/charts.h"
#include "evaluation/report/report_command.h"
#include "tests/evaluation/recording/hand_made_recording.h"
#include "tests/evaluation/refusal.h"
#include "tests/support/command_line.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;
using testing::Not;

foxglove::CompressedImage picture(std::string_view jpeg) {
  foxglove::CompressedImage message;
  message.set_data(std::string(jpeg));
  message.set_format("jpeg");
  message.set_from_camera(true);
  return message;
}

bevloc::recording::Match match(double score) {
  bevloc::recording::Match message;
  message.set_evidence(true);
  message.set_score(score);
  return message;
}

size_t occurrences(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Report, ADamagedPictureIsLeftOutAndNamed) {
  const test::TemporaryFolder folder;
  test::HandMadeRecording made(folder / "bevloc-0001.mcap");
  JpegEncoder encoder;
  const auto good = encoder.encode(RgbImage(16, 8).view(), 80);
  ASSERT_TRUE(good) << good.error().message;
  made.add_pose(0.0, 0.0);
  made.add(firmware::image_topic(0), picture(*good), 0.1);
  made.add(firmware::image_topic(1), picture("no JPEG"), 0.1);
  made.add(firmware::kMatchTopic, match(0.5), 0.2);
  const std::string page = folder / "report.html";
  const std::string recording = made.finish();
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const Status made_page = test::run_command<ReportCommand>({"report", recording, "--out", page});
  testing::internal::GetCapturedStdout();
  const std::string errors = testing::internal::GetCapturedStderr();
  ASSERT_TRUE(made_page) << made_page.error().message;
  EXPECT_THAT(errors, HasSubstr("bevloc-0001.mcap: left out the picture of camera front at "));
  EXPECT_THAT(errors, HasSubstr("(0.1 s): "));
  EXPECT_EQ(occurrences(errors, "left out"), 1U) << errors;
  const std::string text = read_file(page).value();
  EXPECT_EQ(occurrences(text, "no readable picture"), 1U);
  EXPECT_THAT(text, HasSubstr("<img alt='front_left'"));
  EXPECT_THAT(text, Not(HasSubstr("<img alt='front'")));
}

/// `bevloc report --out recording/*.mcap` takes the first file of the recording as the page.
TEST(Report, NeverWritesOverTheRecording) {
  const test::TemporaryFolder folder;
  const auto recording = [&folder](const char* name) {
    test::HandMadeRecording made(folder / name);
    made.add_pose(0.0, 0.0);
    return made.finish().string();
  };
  const std::string first = recording("bevloc-0001.mcap");
  const std::string bytes = read_file(first).value();
  const std::string second = recording("bevloc-0002.mcap");
  EXPECT_THAT(test::refusal_of<ReportCommand>({"report", "--out", first, second}),
              HasSubstr("wanted .html"));
  EXPECT_THAT(test::refusal_of<ReportCommand>({"report", first, "--out", first}),
              HasSubstr("wanted .html"));
  const std::filesystem::path page = folder / "recording.html";
  std::filesystem::create_symlink(first, page);
  EXPECT_THAT(test::refusal_of<ReportCommand>({"report", first, "--out", page.string()}),
              HasSubstr("found a file to write that is also read"));
  EXPECT_EQ(read_file(first).value(), bytes);
}

TEST(Report, AFileMayFollowTheTimes) {
  EXPECT_THAT(test::refusal_of<ReportCommand>(
                  {"report", "--at", "14:32", "--at", "12.5", "/nonexistent/gone.mcap"}),
              HasSubstr("gone.mcap"));
}

TEST(TrackMap, JoinsNothingAcrossAGap) {
  ReportData data;
  for (const double time_s : {0.0, 0.5, 1.0, 10.0, 10.5}) {
    PosedCycle cycle;
    cycle.time_s = time_s;
    cycle.map_from_vehicle.x_m = 10.0 * time_s;
    data.cycles.push_back(cycle);
    data.truth.push_back({Time(from_seconds(time_s)), cycle.map_from_vehicle});
  }
  const std::string svg = track_map(data);
  EXPECT_EQ(occurrences(svg, "stroke-width='3'"), 3U) << svg;
  const size_t truth = svg.find("class='truth' d='");
  ASSERT_NE(truth, std::string::npos) << svg;
  const std::string path = svg.substr(truth + 17, svg.find('\'', truth + 17) - truth - 17);
  EXPECT_EQ(occurrences(path, "M"), 2U) << path;
  EXPECT_EQ(occurrences(path, "L"), 3U) << path;
}

/// A reader of the screen says the name.
TEST(Charts, EachHasAName) {
  ReportData data;
  data.cycles.resize(1);
  EXPECT_THAT(track_map(data), HasSubstr("role='img' aria-label='Track on the map'"));
  EXPECT_THAT(state_bar({}, 1.0), HasSubstr("role='img' aria-label='States over time'"));
  EXPECT_THAT(line_chart("the driver's <error>", "m", {}, 1.0),
              HasSubstr("role='img' aria-label='the driver&#39;s &lt;error&gt; over time'"));
}

}  // namespace
}  // namespace bevloc::evaluation
