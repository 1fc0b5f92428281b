#include "tests/hil/usb_cameras/uvc_camera.h"

#include <algorithm>

namespace bevloc::hil {
namespace {

// Request types (USB 2.0, 9.3; UVC 1.0, 4.1).
constexpr uint8_t kGetStandard = 0x80, kSetClassInterface = 0x21, kGetClassInterface = 0xA1;
constexpr uint8_t kSetEndpoint = 0x02, kDirectionIn = 0x80, kTypeMask = 0x60;
constexpr uint8_t kClearFeature = 1, kGetDescriptor = 6;
constexpr uint8_t kSetCur = 0x01, kGetCur = 0x81, kGetMin = 0x82, kGetMax = 0x83;
constexpr uint8_t kGetLen = 0x85, kGetInfo = 0x86, kGetDef = 0x87;
constexpr int kProbe = 1, kCommit = 2;
constexpr uint8_t kStreamControlBytes = 26;  // of UVC 1.0

// Payload header: its length, then flags (UVC 1.0, 2.4.3.3).
constexpr size_t kHeaderBytes = 2;
constexpr uint8_t kEndOfHeader = 0x80, kEndOfFrame = 0x02;
constexpr uint32_t kMaxPayloadBytes = kYuyvBytes + kHeaderBytes;

uint32_t u32_at(std::span<const uint8_t> data, size_t offset) {
  return data[offset] | (data[offset + 1] << 8) | (data[offset + 2] << 16) |
         (uint32_t{data[offset + 3]} << 24);
}

}  // namespace

void UvcCamera::unplug() {
  link_.reset();
  drop_stream();
}

void UvcCamera::send(std::span<const uint8_t> image) {
  if (!link_ || !is_streaming()) {
    ++counts_.not_streaming;
    return;
  }
  if (!payload_.empty()) {
    ++counts_.skipped;
    return;
  }
  frame_id_ ^= 1;
  payload_ = {kHeaderBytes, static_cast<uint8_t>(kEndOfHeader | kEndOfFrame | frame_id_)};
  payload_.insert(payload_.end(), image.begin(), image.end());
  offset_ = 0;
  pump();
}

std::optional<Bytes> UvcCamera::control(const ControlRequest& request,
                                        std::span<const uint8_t> data) {
  if (request.type == kGetStandard && request.request == kGetDescriptor) {
    return descriptor(request);
  }
  const bool of_stream = (request.index & 0xFF) == kStreamInterface;
  const bool of_class = request.type == kGetClassInterface || request.type == kSetClassInterface;
  if (of_class) return of_stream ? stream_control(request, data) : std::nullopt;
  if ((request.type & kTypeMask) != 0) return std::nullopt;
  // The Linux driver stops a bulk stream by clearing its endpoint's halt.
  if (request.type == kSetEndpoint && request.request == kClearFeature) drop_frame();
  // All other standard requests: status 0, or success without data.
  return (request.type & kDirectionIn) != 0 ? Bytes{0, 0} : Bytes{};
}

std::optional<Bytes> UvcCamera::descriptor(const ControlRequest& request) const {
  constexpr int kDevice = 1, kConfiguration = 2, kString = 3, kQualifier = 6;
  switch (request.value >> 8) {
    case kDevice:
      return device_descriptor();
    case kConfiguration:
      return configuration_descriptor();
    case kQualifier:
      return device_qualifier();
    case kString: {
      Bytes text = string_descriptor(request.value & 0xFF, name_);
      if (text.empty()) return std::nullopt;
      return text;
    }
    default:
      return std::nullopt;
  }
}

std::optional<Bytes> UvcCamera::stream_control(const ControlRequest& request,
                                               std::span<const uint8_t> data) {
  const int selector = request.value >> 8;
  if (selector != kProbe && selector != kCommit) return std::nullopt;
  switch (request.request) {
    case kSetCur: {
      if (data.size() < 8) return std::nullopt;
      format_ = std::clamp<uint8_t>(data[2], 1, 2);
      const uint32_t asked = u32_at(data, 4);
      const auto offered = std::find_if(kFrameRates.rbegin(), kFrameRates.rend(),
                                        [&](int rate) { return frame_interval(rate) >= asked; });
      interval_ = frame_interval(offered == kFrameRates.rend() ? kFrameRates.front() : *offered);
      if (selector == kCommit) drop_frame();
      return Bytes{};
    }
    case kGetCur:
    case kGetMin:
    case kGetMax:
    case kGetDef:
      return negotiated();
    case kGetLen:
      return Bytes{kStreamControlBytes, 0};
    case kGetInfo:
      return Bytes{3};  // readable and writable
    default:
      return std::nullopt;
  }
}

/// Table 4-47 of UVC 1.0.
Bytes UvcCamera::negotiated() const {
  Bytes bytes{1, 0, format_, 1};
  append_u32(bytes, interval_);
  bytes.insert(bytes.end(), {0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  append_u32(bytes, kYuyvBytes);
  append_u32(bytes, kMaxPayloadBytes);
  return bytes;
}

void UvcCamera::bulk_in(uint64_t id, size_t length) {
  wanted_.push_back({id, length});
  pump();
}

void UvcCamera::cancel(uint64_t id) {
  const auto request = std::find_if(wanted_.begin(), wanted_.end(),
                                    [id](const BulkRequest& wanted) { return wanted.id == id; });
  if (request == wanted_.end()) return;
  link_->complete_cancelled(id);
  wanted_.erase(request);
  if (wanted_.empty()) drop_frame();
}

void UvcCamera::drop_frame() {
  if (!payload_.empty()) ++counts_.cut_off;
  payload_.clear();
}

void UvcCamera::drop_stream() {
  drop_frame();
  wanted_.clear();
}

void UvcCamera::pump() {
  while (!payload_.empty() && !wanted_.empty()) {
    const BulkRequest request = wanted_.front();
    wanted_.pop_front();
    const size_t count = std::min(request.length, payload_.size() - offset_);
    link_->complete(request.id, std::span(payload_).subspan(offset_, count));
    offset_ += count;
    // A payload ends with a short transfer, possibly an empty one, or at the negotiated size.
    const bool last =
        offset_ == payload_.size() && (count < request.length || offset_ == kMaxPayloadBytes);
    if (last) {
      payload_.clear();
      ++counts_.sent;
    }
  }
}

}  // namespace bevloc::hil
