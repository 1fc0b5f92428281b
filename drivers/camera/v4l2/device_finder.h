// Finds the video node (such as /dev/video0) of a camera by its stable id.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"

namespace bevloc::drivers::v4l2 {

/// Where the kernel and udev show devices. Tests use their own.
struct DeviceTree {
  std::filesystem::path sysfs = "/sys";
  std::filesystem::path dev = "/dev";
  /// Asks a node whether it delivers images, as can_capture() does. Empty to open no node: a daemon
  /// that waits for a camera must not open others again and again, because some receivers switch
  /// their sensor on and off with that.
  std::function<std::optional<bool>(const std::filesystem::path& node)> can_capture{};
};

/// One video node and its names.
struct VideoNode {
  std::filesystem::path node;
  int index = 0;       ///< number among the nodes of one device
  std::string device;  ///< sysfs path of the node's device, which may have several cameras
  std::string card;    ///< such as "HD USB Camera"
  std::string serial;  ///< serial number of a USB device; empty if it has none
  std::string port;    ///< USB port: "1-4.2" is bus 1, port 4 of the root hub, port 2 of a hub
  std::vector<std::string> links;  ///< names in /dev/v4l/by-id and by-path
};

/// Lists all video nodes in the order of their numbers.
std::vector<VideoNode> list_video_nodes(const DeviceTree& tree = {});

/// Lists the nodes that deliver images, in the order of their numbers. Decides by
/// tree.can_capture(). A node that does not answer counts, unless a node of the same device with a
/// lower index has the same card name: that is how a USB camera shows its metadata, whereas cameras
/// that share a receiver have card names of their own.
std::vector<VideoNode> list_image_nodes(const DeviceTree& tree = {});

/// Returns the node whose by-id or by-path name, USB serial number, USB port or card name is `id`.
/// If several nodes of one device match, returns the first one. Fails when no device or more than
/// one matches, and lists the devices. Also fails for a /dev/video number, because it changes with
/// each boot.
Result<std::filesystem::path> find_video_node(std::string_view id, const DeviceTree& tree = {});

}  // namespace bevloc::drivers::v4l2
