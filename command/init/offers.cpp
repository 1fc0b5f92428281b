#include "command/init/offers.h"

#include <array>
#include <cstdlib>

#include "drivers/camera/v4l2/device_finder.h"
#ifdef BEVLOC_HAS_LIBCAMERA
#include "drivers/camera/libcamera/libcamera_camera.h"
#endif

namespace bevloc::command {
namespace {

/// Returns a name of a node that changes neither with the order in which cameras are plugged in nor
/// with a restart.
std::string stable_id(const drivers::v4l2::VideoNode& node) {
  if (!node.links.empty()) return node.links.front();
  for (const std::string* id : {&node.serial, &node.port, &node.card}) {
    if (!id->empty()) return *id;
  }
  return "";
}

}  // namespace

Offers offers_of(const Machine& machine, const std::vector<std::string>& libcamera_ids) {
  Offers offers;
  for (const auto& node :
       drivers::v4l2::list_video_nodes({machine.real("/sys"), machine.real("/dev")})) {
    const std::string id = stable_id(node);
    // Further nodes of a camera deliver no images.
    if (node.index == 0 && !id.empty()) offers.v4l2.push_back({id, node.card});
  }
  for (const std::string& id : libcamera_ids) offers.libcamera.push_back({id, "libcamera"});
  // ARPHRD_CAN of linux/if_arp.h as text.
  constexpr const char* kCanDevice = "280";
  for (const std::string& name : machine.names_in("/sys/class/net")) {
    if (machine.line_of("/sys/class/net/" + name + "/type") == kCanDevice) {
      offers.can_interfaces.push_back(name);
    }
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
