// Tests the emulated camera with the requests that Linux's uvcvideo sends.
#include "tests/hil/usb_cameras/uvc_camera.h"

#include <gtest/gtest.h>

namespace bevloc::hil {
namespace {

constexpr uint8_t kToHost = 0xA1, kToDevice = 0x21, kStandard = 0x80;
constexpr uint8_t kSetCur = 0x01, kGetCur = 0x81;
constexpr uint16_t kProbe = 0x0100;

TEST(UvcDescriptors, LengthsAddUp) {
  const Bytes bytes = configuration_descriptor();
  ASSERT_EQ(bytes[2] | (bytes[3] << 8), static_cast<int>(bytes.size()));
  size_t offset = 0;
  int interfaces = 0;
  while (offset < bytes.size()) {
    ASSERT_GT(bytes[offset], 1);
    if (bytes[offset + 1] == 0x04) ++interfaces;
    offset += bytes[offset];
  }
  EXPECT_EQ(offset, bytes.size());
  EXPECT_EQ(interfaces, 2);
  EXPECT_EQ(device_descriptor().size(), 18U);
  EXPECT_EQ(device_qualifier().size(), 10U);
}

TEST(UvcDescriptors, SerialNumbersDistinguishCameras) {
  EXPECT_NE(string_descriptor(3, "front"), string_descriptor(3, "back"));
  const Bytes text = string_descriptor(3, "front");
  EXPECT_EQ(text.size(), 2U + 2 * 5);
  EXPECT_EQ(text[0], text.size());
  EXPECT_TRUE(string_descriptor(4, "front").empty());
}

TEST(UvcCamera, AgreesOnAnOfferedFormatAndRate) {
  UvcCamera camera("front");
  Bytes probe{1, 0, static_cast<uint8_t>(PixelFormat::kMjpeg), 1};
  append_u32(probe, frame_interval(4));  // not offered; the next slower rate is 2
  probe.resize(26);
  ASSERT_TRUE(camera.control({kToDevice, kSetCur, kProbe, kStreamInterface, 26}, probe));
  EXPECT_EQ(camera.format(), PixelFormat::kMjpeg);

  const auto agreed = camera.control({kToHost, kGetCur, kProbe, kStreamInterface, 26}, {});
  ASSERT_TRUE(agreed);
  ASSERT_EQ(agreed->size(), 26U);
  Bytes interval;
  append_u32(interval, frame_interval(2));
  EXPECT_TRUE(std::equal(interval.begin(), interval.end(), agreed->begin() + 4));
}

TEST(UvcCamera, StallsOnUnknownRequests) {
  UvcCamera camera("front");
  EXPECT_FALSE(camera.control({kStandard, 6, 0x0900, 0, 64}, {}));  // no such descriptor
  EXPECT_FALSE(camera.control({kToHost, kGetCur, 0x0900, kStreamInterface, 26}, {}));
  EXPECT_FALSE(camera.control({kToDevice, kSetCur, kProbe, kStreamInterface, 3}, Bytes(3)));
  EXPECT_FALSE(camera.control({kToHost, kGetCur, kProbe, kControlInterface, 26}, {}));
}

TEST(UvcCamera, CountsFramesWhileNotStreaming) {
  UvcCamera camera("front");
  camera.send(Bytes(10));
  EXPECT_EQ(camera.counts().not_streaming, 1U);
  EXPECT_EQ(camera.counts().sent, 0U);
}

}  // namespace
}  // namespace bevloc::hil
