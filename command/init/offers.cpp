#include "command/init/offers.h"

#include <algorithm>
#include <cstdlib>

#include "drivers/camera/v4l2/device.h"
#include "drivers/camera/v4l2/device_finder.h"
#ifdef BEVLOC_HAS_LIBCAMERA
#include "drivers/camera/libcamera/libcamera_camera.h"
#endif

namespace bevloc::command {
namespace {

using drivers::v4l2::VideoNode;

/// Returns a name of a node that does not change with a restart. If its serial number is that of no
/// other node, the name stays with the camera when plugs change. Otherwise it belongs to the plug.
std::string stable_id(const VideoNode& node, bool has_own_serial) {
  // Names in /dev/v4l/by-id begin so. Those in by-path begin with the bus of the USB controller.
  const auto is_by_id = [](const std::string& link) { return link.starts_with("usb-"); };
  if (has_own_serial) {
    const auto by_id = std::ranges::find_if(node.links, is_by_id);
    return by_id != node.links.end() ? *by_id : node.serial;
  }
  const auto by_path = std::ranges::find_if_not(node.links, is_by_id);
  if (by_path != node.links.end()) return *by_path;
  return node.port.empty() ? node.card : node.port;
}

}  // namespace

Offers offers_of(const Machine& machine, const std::vector<std::string>& libcamera_ids) {
  Offers offers;
  const std::vector<VideoNode> nodes = drivers::v4l2::list_image_nodes(
      {machine.real("/sys"), machine.real("/dev"), drivers::v4l2::can_capture});
  for (const VideoNode& node : nodes) {
    const bool has_own_serial =
        !node.serial.empty() && std::ranges::count(nodes, node.serial, &VideoNode::serial) == 1;
    const std::string id = stable_id(node, has_own_serial);
    if (!id.empty()) offers.v4l2.push_back({id, node.card});
  }
  for (const std::string& id : libcamera_ids) offers.libcamera.push_back({id, "libcamera"});
  for (const std::string& name : machine.names_in("/sys/class/net")) {
    if (machine.is_can_interface(name)) offers.can_interfaces.push_back(name);
  }
  return offers;
}

std::vector<std::string> libcamera_ids_of_this_machine() {
#ifdef BEVLOC_HAS_LIBCAMERA
  // libcamera logs to stderr, which shows only what the user must know.
  setenv("LIBCAMERA_LOG_LEVELS", "*:ERROR", 0);
  return drivers::libcamera_ids();
#else
  return {};
#endif
}

}  // namespace bevloc::command
