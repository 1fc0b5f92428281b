// Tests what is logged about changes of the appliance's state.
#include "firmware/status/view_log.h"

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
  log.note(view);
  view.state = HealthState::kAcquiring;
  view.why = Why::kMatchUncertain;
  view.lost = 1;
  view.lost_why = Why::kOdometryMissing;
  log.note(view);
  log.note(view);
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
    log.note(view);
  }
  EXPECT_THAT(capture.text(), HasSubstr("GNSS: its headings are 480 ms older than the yaw rate"));
  EXPECT_EQ(capture.text().find("460"), std::string::npos);
  EXPECT_THAT(capture.text(), HasSubstr("GNSS: its headings agree with odometry again"));
}

}  // namespace
}  // namespace bevloc::firmware
