#include "can/bus/socketcan_codec.h"

#include <cstring>
#include <ctime>

#include <gtest/gtest.h>
#include <linux/can/error.h>

namespace bevloc::can {
namespace {

using std::chrono::nanoseconds;
using std::chrono::seconds;

/// A buffer with ancillary data, as the kernel fills it.
class AncillaryBuffer {
 public:
  template <typename T>
  void add(int level, int type, const T& content) {
    cmsghdr header{};
    header.cmsg_level = level;
    header.cmsg_type = type;
    header.cmsg_len = CMSG_LEN(sizeof(content));
    std::memcpy(bytes_ + size_, &header, sizeof(header));
    std::memcpy(bytes_ + size_ + CMSG_LEN(0), &content, sizeof(content));
    size_ += CMSG_SPACE(sizeof(content));
  }

  Ancillary read() {
    msghdr message{};
    message.msg_control = bytes_;
    message.msg_controllen = size_;
    return ancillary_from(message);
  }

 private:
  alignas(cmsghdr) char bytes_[256] = {};
  size_t size_ = 0;
};

struct ThreeStamps {
  timespec stamps[3];
};

TEST(SocketCanCodec, ReadsSoftwareAndHardwareStamps) {
  AncillaryBuffer buffer;
  buffer.add(SOL_SOCKET, SCM_TIMESTAMPING, ThreeStamps{{{10, 1}, {20, 2}, {30, 3}}});
  const Ancillary both = buffer.read();
  EXPECT_EQ(both.stamps.software, seconds(10) + nanoseconds(1));
  EXPECT_EQ(both.stamps.hardware, seconds(30) + nanoseconds(3));
  EXPECT_FALSE(both.dropped_total);
}

TEST(SocketCanCodec, AStampOfZeroIsMissing) {
  AncillaryBuffer buffer;
  buffer.add(SOL_SOCKET, SCM_TIMESTAMPING, ThreeStamps{{{10, 1}, {0, 0}, {0, 0}}});
  EXPECT_TRUE(buffer.read().stamps.software);
  EXPECT_FALSE(buffer.read().stamps.hardware);
}

TEST(SocketCanCodec, ReadsTheStampsOfOlderKernelsAndTheLosses) {
  AncillaryBuffer buffer;
  buffer.add(SOL_SOCKET, SCM_TIMESTAMPNS, timespec{10, 1});
  buffer.add(SOL_SOCKET, SO_RXQ_OVFL, uint32_t{42});
  const Ancillary ancillary = buffer.read();
  EXPECT_EQ(ancillary.stamps.software, seconds(10) + nanoseconds(1));
  EXPECT_EQ(ancillary.dropped_total, 42u);
}

TEST(SocketCanCodec, SkipsUnknownAndTruncatedEntries) {
  AncillaryBuffer buffer;
  buffer.add(SOL_SOCKET, SCM_TIMESTAMPING, uint32_t{1});
  buffer.add(SOL_CAN_BASE, SO_RXQ_OVFL, uint32_t{1});
  buffer.add(SOL_SOCKET, SO_RXQ_OVFL, uint8_t{1});
  buffer.add(SOL_SOCKET, SCM_RIGHTS, uint32_t{1});
  const Ancillary ancillary = buffer.read();
  EXPECT_FALSE(ancillary.stamps.software);
  EXPECT_FALSE(ancillary.stamps.hardware);
  EXPECT_FALSE(ancillary.dropped_total);
}

TEST(SocketCanCodec, ReadsBackClassicAndFdFrames) {
  for (const FrameFormat format : {FrameFormat::kClassic, FrameFormat::kFd}) {
    const Frame frame{.id = 0x7FF, .length = 8, .data = {1, 2, 3, 4, 5, 6, 7, 8}, .format = format};
    const RawFrame raw = raw_from(frame);
    const ReadFrame read = frame_from(raw.content, raw.size);
    ASSERT_TRUE(std::holds_alternative<Frame>(read));
    EXPECT_EQ(std::get<Frame>(read), frame);
  }
}

TEST(SocketCanCodec, ReadsErrorReports) {
  canfd_frame raw{};
  raw.can_id = CAN_ERR_FLAG | CAN_ERR_CRTL;
  raw.len = CAN_ERR_DLC;
  raw.data[1] = CAN_ERR_CRTL_TX_PASSIVE;
  const ReadFrame read = frame_from(raw, CAN_MTU);
  ASSERT_TRUE(std::holds_alternative<ErrorFrame>(read));
  EXPECT_EQ(std::get<ErrorFrame>(read).classes, CAN_ERR_CRTL);
  EXPECT_EQ(std::get<ErrorFrame>(read).data[1], CAN_ERR_CRTL_TX_PASSIVE);
  raw.len = 2;
  EXPECT_TRUE(std::holds_alternative<std::monostate>(frame_from(raw, CAN_MTU)));
}

TEST(SocketCanCodec, RefusesInvalidSizesAndLengths) {
  canfd_frame raw{};
  raw.can_id = 0x123;
  for (const size_t size : {size_t{0}, size_t{4}, size_t{CAN_MTU} + 1, size_t{CANFD_MTU} + 1}) {
    EXPECT_TRUE(std::holds_alternative<std::monostate>(frame_from(raw, size))) << size;
  }
  raw.len = 9;
  EXPECT_TRUE(std::holds_alternative<std::monostate>(frame_from(raw, CAN_MTU)));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(frame_from(raw, CANFD_MTU)));
  raw.len = 12;
  EXPECT_TRUE(std::holds_alternative<Frame>(frame_from(raw, CANFD_MTU)));
}

}  // namespace
}  // namespace bevloc::can
