#include "firmware/status/error_log.h"

#include <algorithm>
#include <cerrno>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/firmware/log_capture.h"

namespace bevloc::firmware {
namespace {

using std::chrono::seconds;
using testing::HasSubstr;

class ErrorLogTest : public testing::Test {
 protected:
  void note(Duration after = seconds(1)) { errors_.note(snapshot_, now_ += after); }
  std::ptrdiff_t lines() const {
    const std::string text = log_.text();
    return std::count(text.begin(), text.end(), '\n');
  }

  LogCapture log_;
  Snapshot snapshot_;
  ErrorLog errors_;
  Time now_{seconds(10)};
};

TEST_F(ErrorLogTest, IsSilentWithoutErrors) {
  snapshot_.cameras[0].captured = 100;
  snapshot_.vehicle_input.odometry_samples = 100;
  snapshot_.estimation.odometry[static_cast<size_t>(TrackerUpdate::kAccepted)] = 100;
  snapshot_.estimation.gnss[static_cast<size_t>(TrackerUpdate::kGated)] = 3;
  for (int k = 0; k < 10; ++k) note();
  EXPECT_EQ(log_.text(), "");
}

TEST_F(ErrorLogTest, LogsAnErrorOnceWhileItLastsAndAgainAfterAQuietMinute) {
  for (int k = 0; k < 300; ++k) {
    ++snapshot_.vehicle_input.wrong_crc;
    note();
  }
  EXPECT_EQ(lines(), 1);
  EXPECT_THAT(log_.text(), HasSubstr("warning: CAN in: found a wrong CRC"));
  note(seconds(61));
  EXPECT_EQ(lines(), 1);
  ++snapshot_.vehicle_input.wrong_crc;
  note();
  EXPECT_EQ(lines(), 2);
  EXPECT_THAT(log_.text(), HasSubstr("counted 301 times"));
}

TEST_F(ErrorLogTest, LogsEachCauseOfItsOwn) {
  snapshot_.cameras[0].unreadable = 1;  // the vision stage says why
  snapshot_.cameras[1].driver.damaged = 1;
  snapshot_.cameras[2].driver.damaged = 1;
  snapshot_.cameras[3].synchronizer.late = 1;
  snapshot_.cameras[3].synchronizer.overflow = 1;
  snapshot_.vehicle_input.repeated = 1;
  snapshot_.vehicle_input.slow_odometry = 1;
  snapshot_.vehicle_input.contradicting_wheels = 1;
  snapshot_.vehicle_input.sharp_turns = 1;
  snapshot_.estimation.odometry[static_cast<size_t>(TrackerUpdate::kImplausible)] = 1;
  snapshot_.estimation.gnss[static_cast<size_t>(TrackerUpdate::kNotFinite)] = 1;
  snapshot_.bus.receive_dropped = 1;
  snapshot_.bus.receive_overrun = 1;
  snapshot_.bus.send_expired = 1;
  snapshot_.bus.send_replaced = 1;
  snapshot_.queue_drops = {.samples = 1, .reports = 1, .predictions = 1};
  note();
  note();
  EXPECT_EQ(lines(), 16);
  for (const char* text :
       {"camera front: damaged frame", "camera front_right: damaged frame",
        "camera back_left: frame came after its frameset",
        "camera back_left: frame dropped because newer ones filled its queue",
        "CAN in: found a repeated counter", "tracker: odometry refused: beyond",
        "tracker: GNSS refused: not a number", "CAN in: frames lost",
        "CAN in: found odometry that comes too seldom",
        "CAN in: found wheel speeds that contradict", "CAN in: found a change of odometry",
        "samples of odometry or GNSS dropped", "reports of vision dropped",
        "CAN in: the controller lost frames", "CAN out: frames dropped because they were too old",
        "CAN out: frames replaced by newer ones"}) {
    EXPECT_THAT(log_.text(), HasSubstr(text));
  }
}

TEST_F(ErrorLogTest, TellsWhyGpsdCannotBeReachedAndNamesTheDropIns) {
  snapshot_.gnss.emplace();
  snapshot_.gnss->gpsd.failed = 1;
  snapshot_.gnss->gpsd.failure = EAFNOSUPPORT;
  note();
  EXPECT_THAT(log_.text(), HasSubstr("gpsd: cannot be reached (Address family not supported"));
  EXPECT_THAT(log_.text(), HasSubstr("the drop-in gnss.conf is installed"));
  snapshot_.gnss->gpsd.failed = 2;
  snapshot_.gnss->gpsd.failure = ECONNREFUSED;
  note();
  EXPECT_EQ(lines(), 2) << "another cause";
  EXPECT_THAT(log_.text(), HasSubstr("gpsd: cannot be reached (Connection refused)"));
  snapshot_.gnss->fixes[static_cast<size_t>(drivers::FixVerdict::kUnsynchronized)] = 1;
  note();
  EXPECT_EQ(lines(), 3);
  EXPECT_THAT(log_.text(), HasSubstr("not synchronized, or whose error may exceed 100 ms"));
  EXPECT_THAT(log_.text(), HasSubstr("the drop-in clock.conf is installed"));
}

TEST_F(ErrorLogTest, TellsWhenAuthenticationFails) {
  snapshot_.authentication.emplace();
  snapshot_.authentication->no_freshness = 50;  // at each start, until the vehicle announces it
  note();
  EXPECT_EQ(log_.text(), "");
  snapshot_.authentication->no_freshness = 400;
  snapshot_.authentication->wrong_mac = 5;
  snapshot_.authentication->incomplete = 2;
  note();
  EXPECT_EQ(lines(), 3);
  EXPECT_THAT(log_.text(), HasSubstr("check that it sends VEH_Freshness"));
  EXPECT_THAT(log_.text(), HasSubstr("compare the key files of vehicle and localizer"));
  EXPECT_THAT(log_.text(), HasSubstr("an authentication without all frames of its epoch"));
}

}  // namespace
}  // namespace bevloc::firmware
