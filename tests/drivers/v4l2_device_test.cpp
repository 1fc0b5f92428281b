#include <cerrno>

#include <gmock/gmock.h>

#include "drivers/camera/v4l2/device.h"

namespace bevloc::drivers::v4l2 {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(V4l2Device, AnErrorOfTheUnitNamesDeviceAllow) {
  const std::string message = open_error("/dev/video7", EPERM);
  EXPECT_THAT(message, AllOf(StartsWith("/dev/video7: "), HasSubstr("DeviceAllow="),
                             HasSubstr("restart the service")));
}

TEST(V4l2Device, OtherErrorsNameTheGroupAndOtherPrograms) {
  for (const int error : {EACCES, EBUSY, ENODEV}) {
    EXPECT_THAT(open_error("/dev/video7", error),
                AllOf(HasSubstr("group video"), HasSubstr("no other program"),
                      Not(HasSubstr("DeviceAllow"))));
  }
}

TEST(V4l2Device, ANodeThatIsAbsentIsAnError) {
  const auto device = Device::open("/dev/bevloc-no-such-video");
  ASSERT_FALSE(device);
  EXPECT_EQ(device.error().message, open_error("/dev/bevloc-no-such-video", ENOENT));
}

TEST(V4l2Device, ANodeThatDoesNotAnswerDoesNotSayWhetherItCaptures) {
  EXPECT_EQ(can_capture("/dev/bevloc-no-such-video"), std::nullopt);
  EXPECT_EQ(can_capture("/dev/null"), std::nullopt);
}

}  // namespace
}  // namespace bevloc::drivers::v4l2
