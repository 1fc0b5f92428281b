#include "drivers/mock/mock_schedule.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bevloc::drivers {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

constexpr Time kStart{milliseconds(5000)};

CameraTiming ten_hertz() {
  CameraTiming timing;
  timing.drive_start = kStart;
  timing.period = milliseconds(100);
  timing.phase = milliseconds(3);
  timing.readout = milliseconds(20);
  return timing;
}

MockSchedule schedule_with(std::vector<CameraFault> faults, Time now = kStart) {
  MockSchedule schedule(ten_hertz(), std::move(faults));
  schedule.restart(now);
  return schedule;
}

std::vector<uint64_t> sequences(MockSchedule schedule, int count) {
  std::vector<uint64_t> numbers;
  for (int i = 0; i < count; ++i) numbers.push_back(schedule.next().sequence);
  return numbers;
}

TEST(MockSchedule, KeepsThePeriod) {
  MockSchedule schedule = schedule_with({});
  for (uint64_t k = 0; k < 20; ++k) {
    const Delivery delivery = schedule.next();
    EXPECT_EQ(delivery.sequence, k);
    EXPECT_EQ(delivery.exposure_start, kStart + milliseconds(3 + 100 * k));
    EXPECT_EQ(delivery.scene_time, delivery.exposure_start);
    EXPECT_EQ(delivery.due, delivery.exposure_start + milliseconds(20));
  }
}

TEST(MockSchedule, BeginsWithTheFirstExposureFromNowOn) {
  const std::vector<std::pair<int, int>> first_ms_of_now_ms = {{-500, 3}, {0, 3},     {3, 3},
                                                               {4, 103},  {103, 103}, {950, 1003}};
  for (const auto& [now_ms, first_ms] : first_ms_of_now_ms) {
    MockSchedule schedule = schedule_with({}, kStart + milliseconds(now_ms));
    const Delivery first = schedule.next();
    EXPECT_EQ(first.exposure_start, kStart + milliseconds(first_ms)) << "now " << now_ms << " ms";
    EXPECT_EQ(first.sequence, 0U);
  }
}

TEST(MockSchedule, DeadCameraLeavesAGap) {
  // The exposures at 0.203, 0.303 and 0.403 s are during the fault.
  EXPECT_THAT(sequences(schedule_with({{CameraFaultKind::kDead, 0.2, 0.5}}), 4),
              ElementsAre(0, 1, 5, 6));
}

TEST(MockSchedule, ACameraThatStaysDeadIsNeverDue) {
  MockSchedule schedule = schedule_with({{CameraFaultKind::kDead, 0.2}});
  EXPECT_LT(schedule.next().due, Time::max());
  EXPECT_LT(schedule.next().due, Time::max());
  EXPECT_EQ(schedule.next().due, Time::max());
  EXPECT_EQ(schedule.next().due, Time::max());
}

TEST(MockSchedule, DropsEveryNth) {
  EXPECT_THAT(sequences(schedule_with({{.kind = CameraFaultKind::kDrop, .every = 3}}), 6),
              ElementsAre(0, 1, 3, 4, 6, 7));
}

TEST(MockSchedule, DuplicatesEveryNth) {
  EXPECT_THAT(sequences(schedule_with({{.kind = CameraFaultKind::kDuplicate, .every = 2}}), 6),
              ElementsAre(0, 1, 1, 2, 3, 3));
}

TEST(MockSchedule, SwapsEveryNthWithTheNext) {
  MockSchedule schedule = schedule_with({{.kind = CameraFaultKind::kSwap, .every = 3}});
  EXPECT_THAT(sequences(schedule, 7), ElementsAre(0, 1, 3, 2, 4, 6, 5));
  Time due = Time::min();
  for (int i = 0; i < 20; ++i) {
    const Delivery delivery = schedule.next();
    EXPECT_GE(delivery.due, due);
    due = delivery.due;
  }
}

TEST(MockSchedule, LateFramesKeepTheirTimeOfExposure) {
  const CameraFault late{CameraFaultKind::kLate, 0.1, 0.2, milliseconds(45)};
  MockSchedule schedule = schedule_with({late});
  for (const int extra_ms : {0, 45, 0}) {
    const Delivery delivery = schedule.next();
    EXPECT_EQ(delivery.due - delivery.exposure_start, milliseconds(20 + extra_ms));
  }
}

TEST(MockSchedule, NothingOvertakesALateFrame) {
  MockSchedule schedule = schedule_with({{CameraFaultKind::kLate, 0.1, 0.2, milliseconds(250)}});
  for (const int due_ms : {23, 373, 373, 373, 423}) {
    EXPECT_EQ(schedule.next().due, kStart + milliseconds(due_ms));
  }
}

TEST(MockSchedule, FrozenFramesShowOneMoment) {
  MockSchedule schedule = schedule_with({{CameraFaultKind::kFrozen, 0.1, 0.4}});
  EXPECT_EQ(schedule.next().scene_time, kStart + milliseconds(3));
  for (int i = 0; i < 3; ++i) {
    const Delivery delivery = schedule.next();
    EXPECT_EQ(delivery.scene_time, kStart + milliseconds(100));
    EXPECT_EQ(delivery.exposure_start, kStart + milliseconds(103 + 100 * i));
  }
  EXPECT_EQ(schedule.next().scene_time, kStart + milliseconds(403));
}

}  // namespace
}  // namespace bevloc::drivers
