#include "drivers/camera/v4l2/device_finder.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <system_error>

namespace bevloc::drivers::v4l2 {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kNodePrefix = "video";

/// Returns the first line of a sysfs file, or an empty text if there is no such file.
std::string attribute(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

int number_in(std::string_view text) {
  int number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

/// Returns the nearest ancestor of a device that is a USB device, or an empty path for a device on
/// another bus.
fs::path usb_device_of(fs::path device, const fs::path& sysfs) {
  std::error_code ignored;
  while (device.has_relative_path() && device != sysfs && device != device.parent_path()) {
    if (fs::exists(device / "idVendor", ignored)) return device;
    device = device.parent_path();
  }
  return {};
}

VideoNode describe(const fs::path& entry, const DeviceTree& tree) {
  std::error_code ignored;
  VideoNode node;
  node.node = tree.dev / entry.filename();
  node.index = number_in(attribute(entry / "index"));
  node.card = attribute(entry / "name");
  const fs::path device = fs::canonical(entry / "device", ignored);
  node.device = device.string();
  if (const fs::path usb = usb_device_of(device, tree.sysfs); !usb.empty()) {
    node.serial = attribute(usb / "serial");
    node.port = usb.filename().string();
  }
  for (const char* folder : {"by-id", "by-path"}) {
    for (const auto& link : fs::directory_iterator(tree.dev / "v4l" / folder, ignored)) {
      if (fs::read_symlink(link, ignored).filename() == entry.filename()) {
        node.links.push_back(link.path().filename().string());
      }
    }
  }
  std::ranges::sort(node.links);
  return node;
}

bool is_called(const VideoNode& node, std::string_view id) {
  return node.card == id || node.serial == id || node.port == id ||
         std::ranges::find(node.links, id) != node.links.end();
}

bool has_earlier_twin(const VideoNode& node, const std::vector<VideoNode>& nodes) {
  return std::ranges::any_of(nodes, [&node](const VideoNode& other) {
    return other.device == node.device && other.card == node.card && other.index < node.index;
  });
}

/// Lists all names of all cameras, for the error message.
std::string names_of(const std::vector<VideoNode>& image_nodes) {
  std::string text;
  for (const VideoNode& node : image_nodes) {
    text += fmt::format("{}card \"{}\"", text.empty() ? "" : "; ", node.card);
    if (!node.serial.empty()) text += fmt::format(", serial \"{}\"", node.serial);
    if (!node.port.empty()) text += fmt::format(", USB port \"{}\"", node.port);
    for (const std::string& link : node.links) text += fmt::format(", \"{}\"", link);
  }
  return text.empty() ? "none" : text;
}

}  // namespace

std::vector<VideoNode> list_video_nodes(const DeviceTree& tree) {
  std::error_code ignored;
  std::vector<VideoNode> nodes;
  for (const auto& entry : fs::directory_iterator(tree.sysfs / "class/video4linux", ignored)) {
    if (entry.path().filename().string().starts_with(kNodePrefix)) {
      nodes.push_back(describe(entry.path(), tree));
    }
  }
  std::ranges::sort(nodes, {}, [](const VideoNode& node) {
    return number_in(node.node.filename().string().substr(kNodePrefix.size()));
  });
  return nodes;
}

std::vector<VideoNode> list_image_nodes(const DeviceTree& tree) {
  const std::vector<VideoNode> nodes = list_video_nodes(tree);
  std::vector<VideoNode> image_nodes;
  for (const VideoNode& node : nodes) {
    const auto answer = tree.can_capture ? tree.can_capture(node.node) : std::nullopt;
    if (answer.value_or(!has_earlier_twin(node, nodes))) image_nodes.push_back(node);
  }
  return image_nodes;
}

Result<fs::path> find_video_node(std::string_view id, const DeviceTree& tree) {
  if (id.starts_with("/dev/video")) {
    return fail(
        "found the camera id {}, which may be another camera after the next boot; wanted a name "
        "from /dev/v4l/by-id or by-path, a USB serial number or port, or a card name",
        id);
  }
  for (const std::string_view folder : {"/dev/v4l/by-id/", "/dev/v4l/by-path/"}) {
    if (id.starts_with(folder)) id.remove_prefix(folder.size());
  }
  const std::vector<VideoNode> nodes = list_video_nodes(tree);
  const VideoNode* found = nullptr;
  for (const VideoNode& node : nodes) {
    if (!is_called(node, id)) continue;
    if (found != nullptr && found->device != node.device) {
      return fail("several cameras are called \"{}\"; available: {}", id,
                  names_of(list_image_nodes(tree)));
    }
    if (found == nullptr || node.index < found->index) found = &node;
  }
  if (found == nullptr) {
    return fail("no camera is called \"{}\"; available: {}", id, names_of(list_image_nodes(tree)));
  }
  return found->node;
}

}  // namespace bevloc::drivers::v4l2
