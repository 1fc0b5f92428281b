// One emulated camera: answers USB Video Class requests and sends frames.
#pragma once

#include <deque>

#include "tests/hil/usb_cameras/usb_link.h"
#include "tests/hil/usb_cameras/uvc_descriptors.h"

namespace bevloc::hil {

/// What happened to the exposed frames.
struct FrameCounts {
  uint64_t sent = 0;           ///< sent completely
  uint64_t not_streaming = 0;  ///< dropped because the host was not streaming
  uint64_t skipped = 0;        ///< dropped because the previous frame was still being sent
  uint64_t cut_off = 0;        ///< the stream stopped in the middle of the frame
};

/// A camera outlives its connection: unplugging drops the frame being sent and the state of the
/// stream, but keeps the counts. One thread.
class UvcCamera final : public UsbFunction {
 public:
  explicit UvcCamera(std::string name) : name_(std::move(name)) {}

  /// Connects the camera to QEMU; owns `fd`.
  void plug_in(int fd) { link_ = std::make_unique<UsbLink>(fd, *this); }
  void unplug();
  UsbLink* link() { return link_.get(); }
  const UsbLink* link() const { return link_.get(); }

  const std::string& name() const { return name_; }
  PixelFormat format() const { return static_cast<PixelFormat>(format_); }
  bool is_streaming() const { return !wanted_.empty(); }
  const FrameCounts& counts() const { return counts_; }

  /// Sends one encoded image. Counts and drops it if the camera is not streaming or still busy.
  void send(std::span<const uint8_t> image);

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
  Bytes payload_;         ///< of the frame being sent; otherwise empty
  size_t offset_ = 0;     ///< of its first byte not yet sent
  uint8_t frame_id_ = 0;  ///< toggles with each frame
  FrameCounts counts_;
};

}  // namespace bevloc::hil
