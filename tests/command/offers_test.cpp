// Tests which ids `bevloc init` takes for cameras.
#include "command/init/offers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/camera/v4l2/device_finder.h"
#include "tests/command/fake_machine.h"

namespace bevloc::command {
namespace {

namespace fs = std::filesystem;

using testing::ElementsAre;

class OffersTest : public testing::Test {
 protected:
  /// Adds a USB camera with a node for images and one for metadata, as uvcvideo creates them.
  void add_camera(int first_number, const std::string& port, const std::string& serial) {
    const std::string usb = "/sys/devices/pci/usb1/" + port;
    machine_.put(usb + "/idVendor", "1209\n");
    if (!serial.empty()) machine_.put(usb + "/serial", serial + "\n");
    for (int index : {0, 1}) add_node(first_number + index, index, "HD Camera", usb);
  }
  void add_node(int number, int index, const std::string& card, const std::string& device) {
    const std::string node = fmt::format("/sys/class/video4linux/video{}", number);
    machine_.put(node + "/index", fmt::format("{}\n", index));
    machine_.put(node + "/name", card + "\n");
    fs::create_directory_symlink(machine_.real(device), machine_.real(node + "/device"));
  }
  /// Adds the link to a node that udev makes in /dev/v4l/by-id or by-path.
  void add_link(const std::string& folder, const std::string& name, int number) {
    const fs::path links = machine_.real("/dev/v4l/" + folder);
    fs::create_directories(links);
    fs::create_symlink(fmt::format("../../video{}", number), links / name);
  }
  /// Returns the offered ids. Expects that the daemon finds the first node of each camera by them.
  std::vector<std::string> ids() {
    std::vector<std::string> found;
    int number = 0;
    for (const OfferedCamera& camera : offers_of(machine_, {}).v4l2) {
      const auto node =
          drivers::v4l2::find_video_node(camera.id, {machine_.real("/sys"), machine_.real("/dev")});
      EXPECT_TRUE(node) << node.error().message;
      if (node) {
        EXPECT_EQ(node->filename(), fmt::format("video{}", number));
      }
      number += 2;
      found.push_back(camera.id);
    }
    return found;
  }

  test::FakeMachine machine_;
};

TEST_F(OffersTest, TakeTheNameWithTheSerialNumber) {
  add_camera(0, "1-2", "SN7");
  add_camera(2, "1-3", "SN8");
  add_link("by-path", "pci-0000:00:14.0-usb-0:2:1.0-video-index0", 0);
  add_link("by-path", "pci-0000:00:14.0-usb-0:3:1.0-video-index0", 2);
  add_link("by-id", "usb-HD_SN7-video-index0", 0);
  add_link("by-id", "usb-HD_SN8-video-index0", 2);
  EXPECT_THAT(ids(), ElementsAre("usb-HD_SN7-video-index0", "usb-HD_SN8-video-index0"));
}

TEST_F(OffersTest, TakeTheSerialNumberWhereThereIsNoLink) {
  add_camera(0, "1-2", "SN7");
  add_camera(2, "1-3", "SN8");
  EXPECT_THAT(ids(), ElementsAre("SN7", "SN8"));
}

/// udev then makes only one link by-id, to one of the cameras.
TEST_F(OffersTest, TakeThePathWhereCamerasShareASerialNumber) {
  add_camera(0, "1-2", "0001");
  add_camera(2, "1-3", "0001");
  add_link("by-path", "pci-0000:00:14.0-usb-0:2:1.0-video-index0", 0);
  add_link("by-path", "pci-0000:00:14.0-usb-0:3:1.0-video-index0", 2);
  add_link("by-id", "usb-HD_0001-video-index0", 2);
  EXPECT_THAT(ids(), ElementsAre("pci-0000:00:14.0-usb-0:2:1.0-video-index0",
                                 "pci-0000:00:14.0-usb-0:3:1.0-video-index0"));
}

TEST_F(OffersTest, TakeThePortOfCamerasWithOneSerialNumberOrNoneAndWithoutLinks) {
  add_camera(0, "1-2", "0001");
  add_camera(2, "1-3", "0001");
  add_camera(4, "1-4", "");
  EXPECT_THAT(ids(), ElementsAre("1-2", "1-3", "1-4"));
}

/// As on a Jetson with GMSL cameras: one device, and a card name for each camera.
TEST_F(OffersTest, ListAllCamerasOfOneReceiver) {
  const std::string receiver = "/sys/devices/platform/tegra-capture-vi";
  fs::create_directories(machine_.real(receiver));
  for (int index : {0, 1}) {
    add_node(index, index, fmt::format("vi-output, isx031 30-001{}", index), receiver);
    add_link("by-path", fmt::format("platform-tegra-capture-vi-video-index{}", index), index);
  }
  const auto cameras = offers_of(machine_, {}).v4l2;
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].id, "platform-tegra-capture-vi-video-index0");
  EXPECT_EQ(cameras[1].id, "platform-tegra-capture-vi-video-index1");
  EXPECT_EQ(cameras[1].name, "vi-output, isx031 30-0011");
}

TEST_F(OffersTest, ListsOnlyCanInterfaces) {
  machine_.put("/sys/class/net/can0/type", "280\n");
  machine_.put("/sys/class/net/eth0/type", "1\n");
  EXPECT_THAT(offers_of(machine_, {}).can_interfaces, ElementsAre("can0"));
}

}  // namespace
}  // namespace bevloc::command
