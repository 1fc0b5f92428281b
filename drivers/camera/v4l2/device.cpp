#include "drivers/camera/v4l2/device.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>

namespace bevloc::drivers::v4l2 {
namespace {

constexpr uint32_t kWantedCapabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;

FileDescriptor open_node(const std::filesystem::path& node) {
  // The device is opened non-blocking, because next_frame() waits in ppoll() with a timeout.
  return FileDescriptor(::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
}

bool has_wanted_capabilities(const v4l2_capability& capability) {
  return (capability.device_caps & kWantedCapabilities) == kWantedCapabilities;
}

}  // namespace

std::string open_error(const std::filesystem::path& node, int error) {
  // The file's mode gives EACCES, and the device filter of a systemd unit gives EPERM.
  const char* const wanted =
      error == EPERM
          ? "a camera that DeviceAllow= of the systemd unit permits; restart the service, because "
            "systemd looks up DeviceAllow= only when it starts a unit"
          : "a camera that is connected, that the group video may use, and that no other program "
            "holds";
  return fmt::format("{}: cannot be opened ({}), wanted {}", node.string(), std::strerror(error),
                     wanted);
}

std::optional<bool> can_capture(const std::filesystem::path& node) {
  const FileDescriptor fd = open_node(node);
  v4l2_capability capability{};
  if (fd.get() < 0 || ioctl(fd.get(), VIDIOC_QUERYCAP, &capability) != 0) return std::nullopt;
  return has_wanted_capabilities(capability);
}

Result<std::shared_ptr<Device>> Device::open(const std::filesystem::path& node) {
  FileDescriptor fd = open_node(node);
  if (fd.get() < 0) return fail("{}", open_error(node, errno));
  std::shared_ptr<Device> device(new Device(std::move(fd)));
  v4l2_capability capability{};
  if (const int error = device->call(VIDIOC_QUERYCAP, &capability)) {
    return fail("{}: is not a V4L2 device: {}", node.string(), std::strerror(error));
  }
  device->name_ =
      fmt::format("{} ({})", reinterpret_cast<const char*>(capability.card), node.string());
  if (!has_wanted_capabilities(capability)) {
    return fail("{}: has V4L2 capabilities {:#x}, wanted single-plane video capture by streaming",
                device->name_, capability.device_caps);
  }
  return device;
}

int Device::call(unsigned long request, void* argument) const {
  while (ioctl(fd_.get(), request, argument) != 0) {
    if (errno != EINTR) return errno;
  }
  return 0;
}

}  // namespace bevloc::drivers::v4l2
