// Connects an emulated USB device to QEMU over the usbredir protocol.
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

/// The behaviour of a device. UsbLink calls it.
class UsbFunction {
 public:
  virtual ~UsbFunction() = default;
  /// Returns the answer, which may be empty; nullopt stalls the endpoint (request not supported).
  virtual std::optional<Bytes> control(const ControlRequest& request,
                                       std::span<const uint8_t> data) = 0;
  /// The USB host requests up to `length` bytes from the stream endpoint. UsbLink::complete() with
  /// the same `id` answers it.
  virtual void bulk_in(uint64_t id, size_t length) = 0;
  /// The USB host cancels the request `id`.
  virtual void cancel(uint64_t id) = 0;
  /// The USB host resets the device.
  virtual void reset() = 0;
};

/// The connection of a device to QEMU. While the link exists, the device is plugged in.
/// One thread.
class UsbLink {
 public:
  /// Owns `fd`, a connected stream socket. `function` must outlive the link.
  UsbLink(int fd, UsbFunction& function);
  ~UsbLink();
  UsbLink(const UsbLink&) = delete;
  UsbLink& operator=(const UsbLink&) = delete;

  int fd() const { return fd_; }
  bool has_data_to_write() const;

  /// Transfer what is possible without blocking. Both return false when QEMU has closed.
  bool read();
  bool write();

  /// Answers a bulk_in() request with data.
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
