#include "sim/faults/fault_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/faults/fault_table.h"

namespace bevloc::sim {
namespace {

using testing::HasSubstr;

TEST(FaultText, ReadsKindTimesCamerasAndAmounts) {
  const auto fault = parse_fault("camera_swapped with=back camera=front for_s=5", 12.5);
  ASSERT_TRUE(fault) << fault.error().message;
  EXPECT_EQ(fault->kind, FaultKind::kCameraSwapped);
  EXPECT_EQ(fault->camera, 1);
  EXPECT_EQ(fault->other_camera, 4);
  EXPECT_DOUBLE_EQ(fault->from_s, 12.5);
  EXPECT_DOUBLE_EQ(fault->until_s, 17.5);
  const auto jump = parse_fault("gnss_jump east_m=-3.5 from_s=20", 1.0);
  ASSERT_TRUE(jump) << jump.error().message;
  EXPECT_DOUBLE_EQ(jump->from_s, 20.0);
  EXPECT_TRUE(std::isinf(jump->until_s));
  EXPECT_DOUBLE_EQ(jump->amounts.east_m, -3.5);
}

TEST(FaultText, NamesWhatIsWrong) {
  const auto error_of = [](std::string_view text) {
    const auto fault = parse_fault(text, 0.0);
    return fault ? std::string() : fault.error().message;
  };
  EXPECT_THAT(error_of(""), HasSubstr("wanted a kind of fault: gnss_jump"));
  EXPECT_THAT(error_of("gnss_jmp"), HasSubstr("found 'gnss_jmp'"));
  EXPECT_THAT(error_of("gnss_jump 3"), HasSubstr("found 3, wanted KEY=VALUE"));
  EXPECT_THAT(error_of("gnss_jump east_m=far"), HasSubstr("east_m: found far"));
  EXPECT_THAT(error_of("gnss_jump factor=2"), HasSubstr("found factor"));
  EXPECT_THAT(error_of("gnss_outage camera=back"), HasSubstr("found camera"));
  EXPECT_THAT(error_of("gnss_outage for_s=5 until_s=100"), HasSubstr("found until_s"));
  EXPECT_THAT(error_of("odometry_scaled"), HasSubstr("found no factor"));
  EXPECT_THAT(error_of("camera_drop every=2.5"), HasSubstr("whole number"));
  EXPECT_THAT(error_of("camera_dark camera=left"), HasSubstr("found left"));
  EXPECT_THAT(error_of("camera_swapped camera=front"), HasSubstr("two cameras"));
  EXPECT_THAT(error_of("gnss_outage from_s=5 until_s=4"), HasSubstr("until_s: found 4"));
}

TEST(FaultText, EveryKindIsReadBackAsItIsWritten) {
  for (const FaultKindInfo& info : fault_kinds()) {
    Fault fault = make_fault(info.kind, 1.5, 9.25);
    if (info.kind == FaultKind::kCameraSwapped) fault.other_camera = 2;
    if (info.input == FaultInput::kCamera) fault.camera = 3;
    for (const AmountInfo& amount : info.amounts) {
      fault.amounts.*amount.member = amount.whole ? amount.high : 0.5 * (amount.low + amount.high);
    }
    const std::string text = to_text(fault);
    const auto again = parse_fault(text, 0.0);
    ASSERT_TRUE(again) << text << ": " << again.error().message;
    EXPECT_EQ(to_text(*again), text);
  }
}

}  // namespace
}  // namespace bevloc::sim
