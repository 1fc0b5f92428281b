#include "sim/faults/fault_board.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace bevloc::sim {
namespace {

TEST(FaultTable, NamesAreUniqueAndFallbacksInRange) {
  std::set<std::string_view> names;
  for (const FaultKindInfo& info : fault_kinds()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    for (const AmountInfo& amount : info.amounts) {
      EXPECT_LT(amount.low, amount.high) << info.name << ' ' << amount.key;
      if (!amount.fallback) continue;
      EXPECT_GE(*amount.fallback, amount.low) << info.name << ' ' << amount.key;
      EXPECT_LE(*amount.fallback, amount.high) << info.name << ' ' << amount.key;
    }
  }
}

TEST(FaultTable, ANewFaultHasTheFallbackAmounts) {
  EXPECT_DOUBLE_EQ(make_fault(FaultKind::kOdometrySlip).amounts.factor, 1.3);
  EXPECT_DOUBLE_EQ(make_fault(FaultKind::kOdometryLock).amounts.factor, 0.3);
  EXPECT_DOUBLE_EQ(make_fault(FaultKind::kCameraDirty, 2.0).from_s, 2.0);
}

TEST(FaultBoard, FaultsAreActiveFromTheirStartUntilBeforeTheirEnd) {
  const FaultBoard board({make_fault(FaultKind::kGnssOutage, 2.0, 4.0)});
  EXPECT_TRUE(board.active(FaultInput::kGnss, 1.999).empty());
  EXPECT_EQ(board.active(FaultInput::kGnss, 2.0).size(), 1U);
  EXPECT_TRUE(board.active(FaultInput::kGnss, 4.0).empty());
  EXPECT_TRUE(board.active(FaultInput::kOdometry, 3.0).empty());
}

TEST(FaultBoard, AFaultWithoutACameraConcernsAll) {
  Fault swapped = make_fault(FaultKind::kCameraSwapped);
  swapped.camera = 1;
  swapped.other_camera = 4;
  const FaultBoard board({make_fault(FaultKind::kCameraDark), swapped});
  EXPECT_EQ(board.active_on_camera(0, 0.0).size(), 1U);
  EXPECT_EQ(board.active_on_camera(1, 0.0).size(), 2U);
  EXPECT_EQ(board.active_on_camera(4, 0.0).size(), 2U);
}

TEST(FaultBoard, FaultsCanBeAddedRemovedAndCleared) {
  FaultBoard board;
  const uint32_t first = board.add(make_fault(FaultKind::kGnssOutage));
  const uint32_t second = board.add(make_fault(FaultKind::kOdometryStuck));
  EXPECT_NE(first, second);
  EXPECT_TRUE(board.remove(first, 0.0));
  EXPECT_FALSE(board.remove(first, 0.0));
  ASSERT_EQ(board.list().size(), 1U);
  EXPECT_EQ(board.list()[0].number, second);
  board.clear(0.0);
  EXPECT_TRUE(board.list().empty());
}

TEST(FaultBoard, TheDriveDoesNotGoBackWhenASuspensionIsCleared) {
  FaultBoard board;
  board.add(make_fault(FaultKind::kClockSuspend, 1.0));
  const uint32_t gap = board.add(make_fault(FaultKind::kClockGap, 1.0));
  EXPECT_TRUE(board.remove(gap, 2.0));
  board.clear(2.0);
  ASSERT_EQ(board.all(FaultInput::kClock).size(), 1U);
  EXPECT_TRUE(board.active(FaultInput::kClock, 2.0).empty());
}

TEST(FaultBoard, ASuspensionThatHasNotBegunIsForgotten) {
  FaultBoard board;
  const uint32_t suspension = board.add(make_fault(FaultKind::kClockSuspend, 3.0));
  EXPECT_TRUE(board.remove(suspension, 2.0));
  EXPECT_TRUE(board.all(FaultInput::kClock).empty());
}

}  // namespace
}  // namespace bevloc::sim
