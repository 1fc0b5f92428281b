#include <gtest/gtest.h>

#include "drivers/camera/libcamera/controls.h"

namespace bevloc::drivers::libcam {
namespace {

/// A control of a version of libcamera that tells whether it is a list.
struct TellingId {
  bool isArray() const { return is_array; }
  bool is_array = false;
};

TEST(LibcameraControls, KnowsTheListsAmongTheControls) {
  namespace controls = libcamera::controls;
  EXPECT_TRUE(is_list(controls::AfWindows));
  EXPECT_TRUE(is_list(controls::ColourCorrectionMatrix));
  EXPECT_TRUE(is_list(controls::ColourGains));
  EXPECT_TRUE(is_list(controls::FrameDurationLimits));
  EXPECT_TRUE(is_list(controls::SensorBlackLevels));
  EXPECT_FALSE(is_list(controls::AeEnable));
  EXPECT_FALSE(is_list(controls::AnalogueGain));
  EXPECT_FALSE(is_list(controls::ExposureTime));
}

TEST(LibcameraControls, AsksLibcameraWhereItCanTell) {
  EXPECT_TRUE(is_list(TellingId{true}));
  EXPECT_FALSE(is_list(TellingId{false}));
}

}  // namespace
}  // namespace bevloc::drivers::libcam
