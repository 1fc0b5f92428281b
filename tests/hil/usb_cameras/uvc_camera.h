// One camera: answers the video class's requests and sends frames through the stream endpoint.
#pragma once

#include <deque>

#include "tests/hil/usb_cameras/usb_link.h"
#include "tests/hil/usb_cameras/uvc_descriptors.h"

namespace bevloc::hil {

/// What became of the frames that were exposed.
struct FrameCounts {
  uint64_t sent = 0;           ///< went out whole
  uint64_t not_streaming = 0;  ///< nobody was listening
  uint64_t skipped = 0;        ///< the frame before was still on its way
  uint64_t cut_off = 0;        ///< the stream stopped in its middle
};

/// Lives longer than its plug: unplugging drops the frame on its way and the stream's state, as a
/// cable does, but counts go on.
class UvcCamera final : public UsbFunction {
 public:
  explicit UvcCamera(std::string name) : name_(std::move(name)) {}

  void plug_in(int fd) { link_ = std::make_unique<UsbLink>(fd, *this); }
  void unplug();
  UsbLink* link() { return link_.get(); }
  const UsbLink* link() const { return link_.get(); }

  const std::string& name() const { return name_; }
  PixelFormat format() const { return static_cast<PixelFormat>(format_); }
  bool is_streaming() const { return !wanted_.empty(); }
  const FrameCounts& counts() const { return counts_; }

  /// Sends one picture as it is; too late or to nobody, it is counted and dropped.
  void send(std::span<const uint8_t> picture);

  std::optional<Bytes> control(const ControlRequest& request,
                               std::span<const uint8_t> data) override;
  void bulk_in(uint64_t id, size_t length) override;
  void cancel(uint64_t id) override;
  void reset() override { drop_stream(); }

 private:
  struct BulkRequest {
    uint64_t id;
    size_t length;
  };

  std::optional<Bytes> descriptor(const ControlRequest& request) const;
  std::optional<Bytes> stream_control(const ControlRequest& request, std::span<const uint8_t> data);
  Bytes negotiated() const;
  void drop_frame();
  void drop_stream();
  void pump();

  const std::string name_;
  std::unique_ptr<UsbLink> link_;
  uint8_t format_ = static_cast<uint8_t>(PixelFormat::kYuyv);
  uint32_t interval_ = frame_interval(kFrameRates.back());
  std::deque<BulkRequest> wanted_;
  Bytes payload_;         ///< of the frame on its way; empty when there is none
  size_t offset_ = 0;     ///< of what has not been sent of it
  uint8_t frame_id_ = 0;  ///< toggles from frame to frame
  FrameCounts counts_;
};

}  // namespace bevloc::hil
