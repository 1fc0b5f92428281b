// Tests what is logged about changes of the appliance's state.
#include "firmware/status/view_log.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/firmware/log_capture.h"

namespace bevloc::firmware {
namespace {

using testing::HasSubstr;

TEST(ViewLogTest, NamesALossThatNoViewShows) {
  const LogCapture capture;
  ViewLog log;
  ApplianceView view;
  view.state = HealthState::kTracking;
  log.note(view, Time{});
  view.state = HealthState::kAcquiring;
  view.why = Why::kMatchUncertain;
  view.lost = 1;
  view.lost_why = Why::kOdometryMissing;
  log.note(view, Time{});
  log.note(view, Time{});
  EXPECT_THAT(capture.text(), HasSubstr("warning: pose lost: odometry missing\n"
                                        "info: state TRACKING -> ACQUIRING: match uncertain\n"));
  EXPECT_EQ(capture.text().find("pose lost"), capture.text().rfind("pose lost"));
}

TEST(ViewLogTest, TellsOnceByHowMuchGnssLags) {
  const LogCapture capture;
  ViewLog log;
  ApplianceView view;
  for (const int lag_ms : {0, 480, 460, 0}) {
    view.gnss_lag_ms = lag_ms;
    log.note(view, Time{});
  }
  EXPECT_THAT(capture.text(), HasSubstr("GNSS: its headings are 480 ms older than the yaw rate"));
  EXPECT_EQ(capture.text().find("460"), std::string::npos);
  EXPECT_THAT(capture.text(), HasSubstr("GNSS: its headings agree with odometry again"));
}

TEST(ViewLogTest, TellsOnceWhetherTheTimeStampsAreLateOrEarly) {
  const LogCapture capture;
  ViewLog log;
  ApplianceView view;
  for (const int offset_ms : {0, 100, 90, 0, -35, 0}) {
    view.stamp_offset_ms = offset_ms;
    log.note(view, Time{});
  }
  EXPECT_THAT(capture.text(), HasSubstr("time stamps are 100 ms too late against the yaw rate"));
  EXPECT_EQ(capture.text().find("90 ms"), std::string::npos);
  EXPECT_THAT(capture.text(), HasSubstr("time stamps are 35 ms too early against the yaw rate"));
  EXPECT_THAT(capture.text(), HasSubstr("time stamps agree with the yaw rate again"));
}

/// Notes views in turn, every 100 ms.
class AlternatingViewsTest : public testing::Test {
 protected:
  void note(const ApplianceView& view, int times = 1) {
    for (int i = 0; i < times; ++i) log_.note(view, now_ += std::chrono::milliseconds(100));
  }
  void alternate(const ApplianceView& a, const ApplianceView& b, int times) {
    for (int i = 0; i < times; ++i) note(i % 2 == 0 ? a : b);
  }
  static ApplianceView view_of(HealthState state, WhyMask why = {}) {
    ApplianceView view;
    view.state = state;
    view.why = why;
    return view;
  }
  auto lines() const {
    const std::string text = capture_.text();
    return std::count(text.begin(), text.end(), '\n');
  }

  const LogCapture capture_;
  ViewLog log_;
  Time now_{std::chrono::hours(1)};
  const ApplianceView tracking_ = view_of(HealthState::kTracking);
  const ApplianceView degraded_ = view_of(HealthState::kDegraded, Why::kGnssMissing);
};

TEST_F(AlternatingViewsTest, LogsAStateThatAlternatesOnce) {
  note(tracking_);
  alternate(degraded_, tracking_, 600);
  EXPECT_EQ(capture_.text(),
            "info: state INIT -> TRACKING\n"
            "info: state TRACKING -> DEGRADED: GNSS missing\n"
            "info: state DEGRADED -> TRACKING\n");
}

TEST_F(AlternatingViewsTest, TheLatestLineTellsTheStateThatStays) {
  note(tracking_);
  alternate(degraded_, tracking_, 599);  // 597 of the changes have no line
  const auto before = lines();
  note(degraded_, 100);
  EXPECT_EQ(lines(), before + 1);
  EXPECT_TRUE(
      capture_.text().ends_with("info: state TRACKING -> DEGRADED: GNSS missing (the latest of 597 "
                                "changes since the previous "
                                "line)\n"))
      << capture_.text();
}

TEST_F(AlternatingViewsTest, OtherReasonsAreLogged) {
  note(tracking_);
  alternate(degraded_, tracking_, 600);
  note(view_of(HealthState::kDegraded, Why::kCameraMissing));
  EXPECT_THAT(capture_.text(), HasSubstr("state TRACKING -> DEGRADED: camera missing"));
}

TEST_F(AlternatingViewsTest, EachLossOfThePoseIsLogged) {
  note(tracking_);
  const auto before = lines();
  alternate(view_of(HealthState::kAcquiring), tracking_, 20);
  alternate(view_of(HealthState::kLost), view_of(HealthState::kFault), 20);
  EXPECT_EQ(lines(), before + 40);
}

TEST_F(AlternatingViewsTest, LogsABusThatAlternatesOnce) {
  ApplianceView passive;
  passive.bus.state = can::BusState::kPassive;
  alternate(passive, {}, 600);
  EXPECT_EQ(lines(), 2) << capture_.text();
  note(passive, 100);
  EXPECT_EQ(lines(), 3) << capture_.text();
}

}  // namespace
}  // namespace bevloc::firmware
