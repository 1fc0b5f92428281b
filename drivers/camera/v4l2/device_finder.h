// Which video node belongs to a camera's stable id.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"

namespace bevloc::drivers::v4l2 {

/// Where the kernel and udev show devices; tests have their own.
struct DeviceTree {
  std::filesystem::path sysfs = "/sys";
  std::filesystem::path dev = "/dev";
};

/// One video node and the names by which it can be called.
struct VideoNode {
  std::filesystem::path node;
  int index = 0;       ///< among the nodes of one device; a USB camera's pictures come from 0
  std::string device;  ///< sysfs path of the device that the node is of
  std::string card;    ///< such as "HD USB Camera"
  std::string serial;  ///< of a USB device that has one
  std::string port;    ///< of a USB device: "1-4.2" is bus 1, port 4 of the root, port 2 of a hub
  std::vector<std::string> links;  ///< names in /dev/v4l/by-id and by-path
};

/// In the order of their numbers.
std::vector<VideoNode> list_video_nodes(const DeviceTree& tree = {});

/// The node whose by-id or by-path name, USB serial number, USB port or card name is `id`; of
/// several nodes of one device the first. Fails, listing what is there, when none has it, when
/// devices share it, and for a /dev/video number, which changes from boot to boot.
Result<std::filesystem::path> find_video_node(std::string_view id, const DeviceTree& tree = {});

}  // namespace bevloc::drivers::v4l2
