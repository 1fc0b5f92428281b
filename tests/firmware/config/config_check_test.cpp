// Tests check_config(), which looks up everything that a configuration names.
#include <algorithm>
#include <regex>

#include <gmock/gmock.h>

#include "tests/firmware/config/config_fixture.h"

namespace bevloc::firmware {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using ConfigCheckTest = ConfigTest;

TEST_F(ConfigCheckTest, NamesTheFirstMissingFile) {
  const auto config = load(with("{procedural_seed: 7}", "{file: town.osm}"));
  ASSERT_TRUE(config) << config.error().message;
  const auto names = [&](const std::string& name) {
    const Status checked = check_config(*config);
    return !checked && checked.error().message.find((folder_ / name).string()) == 0;
  };
  EXPECT_TRUE(names("rig.yaml"));
  std::filesystem::copy_file(kSource / "config/rig_demo.yaml", folder_ / "rig.yaml");
  EXPECT_TRUE(names("sub/model.onnx"));
  std::filesystem::create_directory(folder_ / "sub");
  write("sub/model.onnx", "no model");
  EXPECT_TRUE(names("sub/model.onnx"));
  put_model("sub/model.onnx");
  EXPECT_TRUE(names("town.osm"));
  write("town.osm", "no map");
  EXPECT_TRUE(names("town.osm"));
  put_map("town.osm");
  EXPECT_TRUE(check_config(*config));
}

TEST_F(ConfigCheckTest, ReportsABadRotationWithItsLine) {
  const auto config = load(kSmallest);
  ASSERT_TRUE(config) << config.error().message;
  std::string rig = read_text(kSource / "config/rig_demo.yaml");
  const std::regex rotation(R"(rotation_wxyz: *\[[^\]]*\])");
  std::smatch match;
  ASSERT_TRUE(std::regex_search(rig, match, rotation));
  const auto line = 1 + std::count(rig.begin(), rig.begin() + match.position(), '\n');
  rig.replace(match.position(), match.length(), "rotation_wxyz: [1, 1, 0, 0]");
  write("rig.yaml", rig);
  const Status checked = check_config(*config);
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().message,
              StartsWith((folder_ / "rig.yaml").string() + ":" + std::to_string(line) + ": "));
  EXPECT_THAT(checked.error().message, HasSubstr("rotation_wxyz"));
}

TEST_F(ConfigCheckTest, ReadsTheRecordings) {
  const auto config = load(
      "cameras: {driver: replay, recording: drive}\n"
      "calibration: {rig: rig.yaml}\n"
      "map: {file: town.osm}\n"
      "model: {file: model.onnx}\n"
      "can: {driver: mock}\n");
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_FALSE(config->simulation);
  std::filesystem::copy_file(kSource / "config/rig_demo.yaml", folder_ / "rig.yaml");
  put_model("model.onnx");
  put_map("town.osm");
  const Status checked = check_config(*config);
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().message,
              StartsWith((folder_ / "drive/front_left/frames.txt").string()));
  for (const std::string_view camera : kCameraNames) {
    const std::filesystem::path recording = folder_ / "drive" / camera;
    std::filesystem::create_directories(recording);
    std::ofstream(recording / "frames.txt") << "0 1000 0.png\n";
    std::ofstream(recording / "0.png") << "an image";
  }
  EXPECT_TRUE(check_config(*config));
}

TEST_F(ConfigCheckTest, LooksForTheFoldersOfFilesThatTheDaemonWrites) {
  auto config = load(with("{procedural_seed: 7}", "{file: town.osm}"));
  ASSERT_TRUE(config) << config.error().message;
  std::filesystem::copy_file(kSource / "config/rig_demo.yaml", folder_ / "rig.yaml");
  std::filesystem::create_directory(folder_ / "sub");
  put_model("sub/model.onnx");
  put_map("town.osm");
  write("secoc.key", "00112233445566778899aabbccddeeff\n");
  std::filesystem::permissions(folder_ / "secoc.key", std::filesystem::perms::owner_read);
  const std::filesystem::path in_a_file = folder_ / "town.osm" / "file";
  config->can.secoc = SecocConfig{folder_ / "secoc.key", in_a_file};
  EXPECT_THAT(check_config(*config).error().message,
              StartsWith("can.secoc.starts_file: " + in_a_file.string() + ": cannot be written"));
  config->can.secoc->starts_file = folder_ / "new" / "starts";
  EXPECT_TRUE(check_config(*config));
  config->learned_calibration_file = in_a_file;
  EXPECT_THAT(check_config(*config).error().message,
              StartsWith("calibration.online.file: " + in_a_file.string() + ": cannot be written"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "new")) << "a check writes nothing";
}

/// A configuration of real cameras, none of which is connected here.
const std::string kVehicle =
    "cameras:\n"
    "  driver: v4l2\n"
    "  ids: {front_left: c0, front: c1, front_right: c2, back_left: c3, back: c4, back_right: c5}\n"
    "calibration: {rig: rig.yaml}\n"
    "map: {file: town.osm}\n"
    "model: {file: model.onnx}\n";

TEST_F(ConfigCheckTest, RefusesAMockBusBesideRealCameras) {
  EXPECT_EQ(error_of(kVehicle + "can: {driver: mock}\n"),
            place(7) +
                "can.driver: found mock beside real cameras, wanted socketcan, so that "
                "poses reach the vehicle");
  EXPECT_EQ(error_of(kVehicle + "can: {driver: socketcan, interface: nowhere0}\n"), "");
}

TEST_F(ConfigCheckTest, OpensTheInterfaceAndLooksForTheCameras) {
  auto config = load(kVehicle + "can: {driver: socketcan, interface: nowhere0}\n");
  ASSERT_TRUE(config) << config.error().message;
  std::filesystem::copy_file(kSource / "config/rig_demo.yaml", folder_ / "rig.yaml");
  put_model("model.onnx");
  put_map("town.osm");
  Status checked = check_config(*config);
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().message, StartsWith("can.interface: nowhere0: "));
  config->can.driver = CanDriver::kMock;
  checked = check_config(*config);
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().message, StartsWith("camera front_left: "));
}

}  // namespace
}  // namespace bevloc::firmware
