// Tests that cameras are found by their stable names, in a simulated /sys and /dev.
#include <fstream>

#include <gtest/gtest.h>

#include "drivers/camera/v4l2/device_finder.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::drivers::v4l2 {
namespace {

namespace fs = std::filesystem;

class DeviceFinder : public testing::Test {
 protected:
  DeviceFinder() {
    tree_ = {folder_ / "sys", folder_ / "dev"};
    fs::create_directories(tree_.sysfs / "class/video4linux");
    fs::create_directories(tree_.dev / "v4l/by-id");
    fs::create_directories(tree_.dev / "v4l/by-path");
  }

  static void write(const fs::path& file, const std::string& text) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << text << "\n";
  }

  void add_node(int number, int index, const std::string& card, const fs::path& device) {
    const fs::path entry = tree_.sysfs / "class/video4linux" / fmt::format("video{}", number);
    write(entry / "index", std::to_string(index));
    write(entry / "name", card);
    fs::create_directories(device);
    fs::create_directory_symlink(device, entry / "device");
  }

  /// Adds a USB camera with a node for images and one for metadata, as uvcvideo creates them.
  void add_usb_camera(int first_number, const std::string& port, const std::string& serial) {
    const fs::path usb = tree_.sysfs / "devices/pci/usb1" / port;
    write(usb / "idVendor", "1209");
    write(usb / "serial", serial);
    const fs::path interface = usb / (port + ":1.0");
    add_node(first_number + 1, 1, "HD Camera", interface);
    add_node(first_number, 0, "HD Camera", interface);
    fs::create_symlink(fmt::format("../../video{}", first_number),
                       tree_.dev / "v4l/by-id" / fmt::format("usb-HD_{}-video-index0", serial));
  }

  std::string found(std::string_view id) {
    const auto node = find_video_node(id, tree_);
    return node ? node->filename().string() : "error: " + node.error().message;
  }

  const test::TemporaryFolder folder_;
  DeviceTree tree_;
};

TEST_F(DeviceFinder, FindsACameraByEachOfItsNames) {
  add_usb_camera(0, "1-2", "SN7");
  add_usb_camera(2, "1-4.1", "SN8");
  EXPECT_EQ(found("SN8"), "video2");
  EXPECT_EQ(found("1-4.1"), "video2");
  EXPECT_EQ(found("usb-HD_SN8-video-index0"), "video2");
  EXPECT_EQ(found("/dev/v4l/by-id/usb-HD_SN8-video-index0"), "video2");
  EXPECT_EQ(found("SN7"), "video0");
}

TEST_F(DeviceFinder, FindsACameraThatIsNotOnUsb) {
  add_node(5, 0, "csi-bridge", tree_.sysfs / "devices/platform/csi0");
  fs::create_symlink("../../video5", tree_.dev / "v4l/by-path/platform-csi0-video-index0");
  EXPECT_EQ(found("csi-bridge"), "video5");
  EXPECT_EQ(found("platform-csi0-video-index0"), "video5");
}

TEST_F(DeviceFinder, ReturnsTheNodeThatDeliversImages) {
  add_usb_camera(10, "1-2", "SN7");
  EXPECT_EQ(found("SN7"), "video10");
  EXPECT_EQ(list_video_nodes(tree_).size(), 2U);
}

TEST_F(DeviceFinder, RefusesANameThatTwoCamerasShare) {
  add_usb_camera(0, "1-2", "SN7");
  add_usb_camera(2, "1-4", "SN8");
  EXPECT_NE(found("HD Camera").find("several cameras"), std::string::npos);
}

TEST_F(DeviceFinder, ListsTheDevicesWhenItFindsNone) {
  EXPECT_NE(found("SN9").find("available: none"), std::string::npos);
  add_usb_camera(0, "1-2", "SN7");
  const std::string error = found("SN9");
  for (const char* name : {"SN9", "SN7", "1-2", "HD Camera", "usb-HD_SN7-video-index0"}) {
    EXPECT_NE(error.find(name), std::string::npos) << name << " in: " << error;
  }
}

/// The nodes of the cameras that share the receiver of a Jetson.
TEST_F(DeviceFinder, ListsAllCamerasOfOneReceiver) {
  const fs::path receiver = tree_.sysfs / "devices/platform/tegra-capture-vi";
  add_node(0, 0, "vi-output, isx031 30-001a", receiver);
  add_node(1, 1, "vi-output, isx031 30-001b", receiver);
  const std::string error = found("SN9");
  EXPECT_NE(error.find("30-001a"), std::string::npos) << error;
  EXPECT_NE(error.find("30-001b"), std::string::npos) << error;
  EXPECT_EQ(found("vi-output, isx031 30-001b"), "video1");
}

TEST_F(DeviceFinder, CountsTheNodesOfAUsbCameraAsOne) {
  add_usb_camera(0, "1-2", "SN7");
  const std::vector<VideoNode> nodes = list_image_nodes(tree_);
  ASSERT_EQ(nodes.size(), 1U);
  EXPECT_EQ(nodes[0].node.filename(), "video0");
}

TEST_F(DeviceFinder, LeavesOutNodesThatSayThatTheyDeliverNoImages) {
  add_node(0, 0, "bcm2835-codec-decode", tree_.sysfs / "devices/platform/codec");
  add_node(1, 0, "HD Camera", tree_.sysfs / "devices/pci/usb1/1-2");
  add_node(2, 1, "HD Camera", tree_.sysfs / "devices/pci/usb1/1-2");
  add_node(3, 0, "csi-bridge", tree_.sysfs / "devices/platform/csi0");
  tree_.can_capture = [](const fs::path& node) -> std::optional<bool> {
    if (node.filename() == "video3") return std::nullopt;
    return node.filename() != "video0";
  };
  std::vector<std::string> names;
  for (const VideoNode& node : list_image_nodes(tree_)) names.push_back(node.node.filename());
  EXPECT_EQ(names, (std::vector<std::string>{"video1", "video2", "video3"}));
}

TEST_F(DeviceFinder, RefusesNumbers) {
  add_usb_camera(0, "1-2", "SN7");
  EXPECT_NE(found("/dev/video0").find("another camera after the next boot"), std::string::npos);
}

}  // namespace
}  // namespace bevloc::drivers::v4l2
