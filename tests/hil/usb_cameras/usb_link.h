// One emulated USB device, plugged into QEMU by the usbredir protocol.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "tests/hil/usb_cameras/uvc_descriptors.h"

struct usbredirparser;

namespace bevloc::hil {

/// A USB control request (USB 2.0, 9.3).
struct ControlRequest {
  uint8_t type = 0;
  uint8_t request = 0;
  uint16_t value = 0;
  uint16_t index = 0;
  uint16_t length = 0;
};

/// What a device does; called by its UsbLink.
class UsbFunction {
 public:
  virtual ~UsbFunction() = default;
  /// The answer, empty for one without data; nothing means a stall: not understood.
  virtual std::optional<Bytes> control(const ControlRequest& request,
                                       std::span<const uint8_t> data) = 0;
  /// The host wants up to `length` bytes from the stream endpoint.
  virtual void bulk_in(uint64_t id, size_t length) = 0;
  virtual void cancel(uint64_t id) = 0;
  virtual void reset() = 0;
};

/// The plug: as long as it lives, the device is plugged in. One thread.
class UsbLink {
 public:
  /// Takes `fd`, a connected stream socket. `function` must outlive the link.
  UsbLink(int fd, UsbFunction& function);
  ~UsbLink();
  UsbLink(const UsbLink&) = delete;
  UsbLink& operator=(const UsbLink&) = delete;

  int fd() const { return fd_; }
  bool has_data_to_write() const;

  /// Both false when QEMU has gone.
  bool read();
  bool write();

  void complete(uint64_t id, std::span<const uint8_t> data);
  void complete_cancelled(uint64_t id);

 private:
  struct Callbacks;

  int fd_;
  UsbFunction& function_;
  usbredirparser* parser_;
  uint8_t configuration_ = 0;
  uint8_t alternate_[2] = {0, 0};
};

}  // namespace bevloc::hil
