// Tests the page that `bevloc status` prints, with the daemon's own /status.json.
#include "command/status/status_page.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "firmware/status/status_json.h"
#include "tests/firmware/status/running_telemetry.h"

namespace bevloc::command {
namespace {

using firmware::running;
using firmware::Telemetry;
using testing::HasSubstr;
using testing::Not;

std::string page_of(const Telemetry& telemetry, Duration age = {}) {
  return status_page(status_json(telemetry, {2e6, 1.0}, age));
}

TEST(StatusPage, FitsATerminal) {
  const std::string page = page_of(running(HealthState::kDegraded, Why::kGnssMissing));
  EXPECT_THAT(page, HasSubstr("DEGRADED, pose valid\n  GNSS missing: Check the antenna"));
  EXPECT_THAT(page, HasSubstr("protection        1.25 m      1.50 m    2.00 deg\n"));
  EXPECT_THAT(page, HasSubstr("front_left  "));
  std::istringstream lines(page);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) EXPECT_LE(line.size(), 100u) << line;
  EXPECT_LE(count, 24);
}

TEST(StatusPage, ShowsWhatCamerasAndBusLost) {
  Telemetry telemetry = running(HealthState::kTracking);
  telemetry.snapshot.cameras[1].unreadable = 23;
  telemetry.snapshot.cameras[1].failures = 45;
  telemetry.snapshot.bus.send_expired = 67;
  telemetry.snapshot.bus.receive_dropped = 89;
  telemetry.snapshot.bus.receive_overrun = 12;
  const std::string page = page_of(telemetry);
  EXPECT_THAT(page, HasSubstr("unreadable  failures  faults\n"));
  EXPECT_THAT(page, testing::ContainsRegex("front +NO +0 +0 +0 +23 +45  \n"));
  EXPECT_THAT(page, HasSubstr("0 sent and 67 dropped, 0 received and 89 lost, 12 overruns"));
}

TEST(StatusPage, ShowsWhyInputsThatArriveAreNotUsed) {
  Telemetry telemetry = running(HealthState::kAcquiring, Why::kOdometryMissing);
  telemetry.snapshot.framesets.refused = 12;
  telemetry.snapshot.vehicle_input.incomplete = 23;
  telemetry.snapshot.vehicle_input.not_available = 34;
  telemetry.snapshot.vehicle_input.contradicting_wheels = 45;
  telemetry.snapshot.vehicle_input.slow_odometry = 56;
  const std::string page = page_of(telemetry);
  EXPECT_THAT(page, HasSubstr("odometry missing: Check that wheel speed and yaw rate arrive, pass "
                              "the E2E check and are not SNA.\n"));
  EXPECT_THAT(page, HasSubstr("0 without a prior, 12 with too few usable images\n"));
  EXPECT_THAT(page,
              HasSubstr("0 refused by E2E\n            23 epochs incomplete, 34 SNA or out of "
                        "range, 45 implausible, 56 came too rarely\n"));
}

TEST(StatusPage, ShowsNoLatencyBeforeOneWasMeasured) {
  Telemetry telemetry = running(HealthState::kAcquiring);
  EXPECT_THAT(page_of(telemetry), HasSubstr("latency - ms median, - ms for 99 %\n"));
  telemetry.snapshot.estimation.latency.in_range[0] = 1;
  EXPECT_THAT(page_of(telemetry), HasSubstr("latency 5 ms median, 10 ms for 99 %\n"));
}

TEST(StatusPage, ShowsWhatTheAuthenticationRefused) {
  Telemetry telemetry = running(HealthState::kTracking);
  EXPECT_FALSE(status_json(telemetry, {}, {}).contains("authentication"));
  EXPECT_THAT(page_of(telemetry), Not(HasSubstr("SecOC")));
  telemetry.snapshot.authentication = {
      .authentic = 1, .wrong_mac = 2, .incomplete = 3, .no_freshness = 4};
  EXPECT_THAT(page_of(telemetry),
              HasSubstr("SecOC       1 epochs authentic; refused: 2 wrong code, 3 incomplete, 4 no "
                        "freshness\n"));
}

TEST(StatusPage, SaysHowOftenAndWhyThePoseWasLost) {
  Telemetry telemetry = running(HealthState::kTracking);
  EXPECT_THAT(page_of(telemetry), Not(HasSubstr("lost 0 times")));
  telemetry.snapshot.estimation.lost = 2;
  telemetry.snapshot.estimation.lost_why = Why::kOdometryMissing;
  EXPECT_THAT(page_of(telemetry),
              HasSubstr("lost 2 times, the latest time because of: odometry missing\n"));
}

TEST(StatusPage, SaysWhyThePoseIsNotValid) {
  EXPECT_THAT(page_of(running(HealthState::kTracking), std::chrono::seconds(3)),
              HasSubstr("TRACKING, pose NOT valid, NOT healthy\n  the supervisor has said nothing "
                        "for 3 s. Restart the service.\n"));
}

TEST(StatusPage, ShowsWhatBecameOfTheReportsOfGpsd) {
  Telemetry telemetry = running(HealthState::kTracking);
  firmware::GnssCounters& gnss = telemetry.snapshot.gnss.emplace();
  gnss.connected = true;
  gnss.samples = 5;
  gnss.gpsd.lines[static_cast<size_t>(drivers::GpsdLine::kNoFix)] = 3;
  gnss.fixes[static_cast<size_t>(drivers::FixVerdict::kStale)] = 2;
  gnss.fixes[static_cast<size_t>(drivers::FixVerdict::kUsable)] = 5;
  EXPECT_THAT(page_of(telemetry), HasSubstr("gpsd        connected; 5 samples, 3 reports and 2"));
}

TEST(StatusPage, ShowsTheRecording) {
  Telemetry telemetry = running(HealthState::kTracking);
  telemetry.snapshot.recording = {.images_dropped = 3,
                                  .events_dropped = 4,
                                  .bytes = 5'000'000,
                                  .black_boxes = 6,
                                  .failed = true};
  EXPECT_THAT(page_of(telemetry),
              HasSubstr("recording   FAILED after 5 MB; 3 images and 4 events dropped, 6 black "
                        "boxes kept\n"));
}

TEST(StatusPage, ShowsStandbyAndSurvivesOtherVersions) {
  Telemetry standby;
  standby.phase = firmware::Phase::kStandby;
  EXPECT_THAT(page_of(standby), HasSubstr("standby: ignition off"));
  EXPECT_THAT(status_page({{"phase", "running"}}), HasSubstr("NOT valid"));
  EXPECT_THAT(status_page(nlohmann::json::array()), HasSubstr("no status"));
}

}  // namespace
}  // namespace bevloc::command
