#include "drivers/mock/mock_schedule.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bevloc::drivers {
namespace {

using sim::FaultKind;
using sim::make_fault;
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

MockSchedule schedule_with(const std::vector<sim::Fault>& faults, Time now = kStart) {
  MockSchedule schedule(ten_hertz(), 1, std::make_shared<const sim::FaultBoard>(faults));
  schedule.restart(now);
  return schedule;
}

std::vector<uint64_t> sequences(MockSchedule schedule, int count) {
  std::vector<uint64_t> numbers;
  while (numbers.size() < static_cast<size_t>(count)) {
    const Delivery delivery = schedule.next();
    if (!delivery.lost) numbers.push_back(delivery.sequence);
  }
  return numbers;
}

sim::Fault every(FaultKind kind, int n) {
  sim::Fault fault = make_fault(kind);
  fault.amounts.every = n;
  return fault;
}

sim::Fault late(double from_s, double until_s, double delay_ms) {
  sim::Fault fault = make_fault(FaultKind::kCameraLate, from_s, until_s);
  fault.amounts.delay_ms = delay_ms;
  return fault;
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
  EXPECT_THAT(sequences(schedule_with({make_fault(FaultKind::kCameraDead, 0.2, 0.5)}), 4),
              ElementsAre(0, 1, 5, 6));
}

TEST(MockSchedule, DropsEveryNth) {
  EXPECT_THAT(sequences(schedule_with({every(FaultKind::kCameraDrop, 3)}), 6),
              ElementsAre(0, 1, 3, 4, 6, 7));
}

TEST(MockSchedule, DuplicatesEveryNth) {
  EXPECT_THAT(sequences(schedule_with({every(FaultKind::kCameraDuplicate, 2)}), 6),
              ElementsAre(0, 1, 1, 2, 3, 3));
}

TEST(MockSchedule, SwapsEveryNthWithTheNext) {
  MockSchedule schedule = schedule_with({every(FaultKind::kCameraOutOfOrder, 3)});
  EXPECT_THAT(sequences(schedule, 7), ElementsAre(0, 1, 3, 2, 4, 6, 5));
  Time due = Time::min();
  for (int i = 0; i < 20; ++i) {
    const Delivery delivery = schedule.next();
    EXPECT_GE(delivery.due, due);
    due = delivery.due;
  }
}

TEST(MockSchedule, LateFramesKeepTheirTimeOfExposure) {
  MockSchedule schedule = schedule_with({late(0.1, 0.2, 45)});
  for (const int extra_ms : {0, 45, 0}) {
    const Delivery delivery = schedule.next();
    EXPECT_EQ(delivery.due - delivery.exposure_start, milliseconds(20 + extra_ms));
  }
}

TEST(MockSchedule, NothingOvertakesALateFrame) {
  MockSchedule schedule = schedule_with({late(0.1, 0.2, 250)});
  for (const int due_ms : {23, 373, 373, 373, 423}) {
    EXPECT_EQ(schedule.next().due, kStart + milliseconds(due_ms));
  }
}

TEST(MockSchedule, FrozenFramesShowOneMoment) {
  MockSchedule schedule = schedule_with({make_fault(FaultKind::kCameraFrozen, 0.1, 0.4)});
  EXPECT_EQ(schedule.next().scene_time, kStart + milliseconds(3));
  for (int i = 0; i < 3; ++i) {
    const Delivery delivery = schedule.next();
    EXPECT_EQ(delivery.scene_time, kStart + milliseconds(100));
    EXPECT_EQ(delivery.exposure_start, kStart + milliseconds(103 + 100 * i));
  }
  EXPECT_EQ(schedule.next().scene_time, kStart + milliseconds(403));
}

TEST(MockSchedule, ALoopRepeatsItsFirstPictures) {
  sim::Fault loop = make_fault(FaultKind::kCameraLoop, 0.2);
  loop.amounts.pictures = 3;
  MockSchedule schedule = schedule_with({loop});
  // The first exposure of the loop is at 0.203 s.
  for (const int shown_ms : {3, 103, 203, 303, 403, 203, 303, 403, 203}) {
    EXPECT_EQ(schedule.next().scene_time, kStart + milliseconds(shown_ms));
  }
}

TEST(MockSchedule, ShiftedStampsLeavePictureAndArrivalAsTheyAre) {
  sim::Fault shift = make_fault(FaultKind::kCameraTimeShift, 0.1);
  shift.amounts.shift_ms = -80.0;
  MockSchedule schedule = schedule_with({shift});
  EXPECT_EQ(schedule.next().exposure_start, kStart + milliseconds(3));
  const Delivery shifted = schedule.next();
  EXPECT_EQ(shifted.exposure_start, kStart + milliseconds(23));
  EXPECT_EQ(shifted.scene_time, kStart + milliseconds(103));
  EXPECT_EQ(shifted.due, kStart + milliseconds(123));
  EXPECT_EQ(schedule.true_exposure_start(shifted), kStart + milliseconds(103));
}

TEST(MockSchedule, AFaultOfAnotherCameraDoesNothing) {
  sim::Fault dead = make_fault(FaultKind::kCameraDead);
  dead.camera = 4;
  EXPECT_FALSE(schedule_with({dead}).next().lost);
  dead.camera = 1;
  EXPECT_TRUE(schedule_with({dead}).next().lost);
}

}  // namespace
}  // namespace bevloc::drivers
