#include "can/bus/socketcan_codec.h"

#include <algorithm>
#include <cstring>

#include <linux/can/error.h>

#include "common/kernel_time.h"

namespace bevloc::can {
namespace {

/// The kernel fills a missing stamp with zeros.
std::optional<Duration> stamp_from(const timespec& time) {
  const Duration stamp = duration_of(time);
  if (stamp == Duration::zero()) return std::nullopt;
  return stamp;
}

template <typename T>
bool read_content(const cmsghdr& entry, T& content) {
  if (entry.cmsg_len < CMSG_LEN(sizeof(content))) return false;
  std::memcpy(&content, CMSG_DATA(&entry), sizeof(content));
  return true;
}

/// This struct has the layout of `struct scm_timestamping`: the software stamp, an unused stamp and
/// the hardware stamp.
struct ThreeStamps {
  timespec stamps[3];
};

ErrorFrame error_frame_from(const canfd_frame& content) {
  ErrorFrame error{.classes = content.can_id & CAN_ERR_MASK};
  std::copy_n(content.data, error.data.size(), error.data.begin());
  return error;
}

}  // namespace

RawFrame raw_from(const Frame& frame) {
  RawFrame raw;
  raw.content.can_id = frame.id;
  raw.content.len = frame.length;
  std::copy_n(frame.data.begin(), frame.length, raw.content.data);
  const bool fd = frame.format == FrameFormat::kFd;
  if (fd) raw.content.flags = CANFD_BRS;
  raw.size = fd ? CANFD_MTU : CAN_MTU;
  return raw;
}

ReadFrame frame_from(const canfd_frame& content, size_t size) {
  if (size != CAN_MTU && size != CANFD_MTU) return {};
  const FrameFormat format = size == CANFD_MTU ? FrameFormat::kFd : FrameFormat::kClassic;
  if (!is_valid_length(format, content.len)) return {};
  if ((content.can_id & CAN_ERR_FLAG) != 0) {
    if (format == FrameFormat::kFd || content.len != CAN_ERR_DLC) return {};
    return error_frame_from(content);
  }
  if ((content.can_id & (CAN_EFF_FLAG | CAN_RTR_FLAG)) != 0) return {};
  Frame frame{.id = content.can_id & CAN_SFF_MASK, .length = content.len, .format = format};
  std::copy_n(content.data, content.len, frame.data.begin());
  return frame;
}

Ancillary ancillary_from(msghdr& message) {
  Ancillary ancillary;
  for (cmsghdr* entry = CMSG_FIRSTHDR(&message); entry != nullptr;
       entry = CMSG_NXTHDR(&message, entry)) {
    if (entry->cmsg_level != SOL_SOCKET) continue;
    ThreeStamps three{};
    timespec one{};
    uint32_t dropped = 0;
    if (entry->cmsg_type == SCM_TIMESTAMPING && read_content(*entry, three)) {
      ancillary.stamps = {stamp_from(three.stamps[0]), stamp_from(three.stamps[2])};
    } else if (entry->cmsg_type == SCM_TIMESTAMPNS && read_content(*entry, one)) {
      ancillary.stamps.software = stamp_from(one);
    } else if (entry->cmsg_type == SO_RXQ_OVFL && read_content(*entry, dropped)) {
      ancillary.dropped_total = dropped;
    }
  }
  return ancillary;
}

}  // namespace bevloc::can
