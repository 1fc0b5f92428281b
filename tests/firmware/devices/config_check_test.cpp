// Tests check_config(), which looks up everything that a configuration names.
#include "firmware/devices/config_check.h"

#include <algorithm>
#include <regex>

#include <gmock/gmock.h>

#include "firmware/devices/camera_factory.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/network/test_frame.h"
#include "tests/firmware/config/config_fixture.h"
#include "tests/firmware/log_capture.h"
#include "tests/support/demo_rig.h"
#include "tests/support/turned_rig.h"

namespace bevloc::firmware {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using ConfigCheckTest = ConfigTest;

TEST_F(ConfigCheckTest, NamesTheFirstMissingFile) {
  const auto config = load(with("{procedural_seed: 7}", "{file: town.osm}"));
  ASSERT_TRUE(config) << config.error().message;
  const auto expect_refused = [&](const std::string& key, const std::string& name) {
    const Status checked = check_config(*config);
    ASSERT_FALSE(checked) << name;
    EXPECT_THAT(checked.error().message, StartsWith(key + ": " + (folder_ / name).string()));
  };
  expect_refused("calibration.rig", "rig.yaml");
  std::filesystem::copy_file(kSource / "config/rig_demo.yaml", folder_ / "rig.yaml");
  expect_refused("model.file", "sub/model.onnx");
  std::filesystem::create_directory(folder_ / "sub");
  write("sub/model.onnx", "no model");
  expect_refused("model.file", "sub/model.onnx");
  put_model("sub/model.onnx");
  expect_refused("map.file", "town.osm");
  write("town.osm", "no map");
  expect_refused("map.file", "town.osm");
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
              StartsWith("calibration.rig: " + (folder_ / "rig.yaml").string() + ":" +
                         std::to_string(line) + ": "));
  EXPECT_THAT(checked.error().message, HasSubstr("rotation_wxyz"));
}

TEST_F(ConfigCheckTest, JudgesWhatTheCamerasShow) {
  const auto config = load(kSmallest);
  ASSERT_TRUE(config) << config.error().message;
  std::filesystem::create_directory(folder_ / "sub");
  put_model("sub/model.onnx");
  const std::string found = "calibration.rig: " + (folder_ / "rig.yaml").string() +
                            ": found cameras that show only a part of the network image";
  const auto put_rig = [this](double down_deg) {
    write("rig.yaml", format_rig(test::turned_down(test::demo_rig(), down_deg)));
  };
  put_rig(40.0);
  const Status refused = check_config(*config);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, StartsWith(found));
  put_rig(30.0);
  const LogCapture log;
  const Status checked = check_config(*config);
  EXPECT_TRUE(checked) << checked.error().message;
  EXPECT_THAT(log.text(), HasSubstr("warning: " + found));
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

class GoodFilesTest : public ConfigCheckTest {
 protected:
  /// A configuration whose rig, model and map are good, and the file of a good key.
  Result<evaluation::DriveConfig> load_good() {
    std::filesystem::copy_file(kSource / "config/rig_demo.yaml", folder_ / "rig.yaml");
    std::filesystem::create_directory(folder_ / "sub");
    put_model("sub/model.onnx");
    put_map("town.osm");
    write("secoc.key", "00112233445566778899aabbccddeeff\n");
    std::filesystem::permissions(folder_ / "secoc.key", std::filesystem::perms::owner_read);
    return load(with("{procedural_seed: 7}", "{file: town.osm}"));
  }
};

TEST_F(GoodFilesTest, TheNumberOfStartsIsRead) {
  auto config = load_good();
  ASSERT_TRUE(config) << config.error().message;
  config->can.secoc = SecocConfig{folder_ / "secoc.key", folder_ / "starts"};
  write("starts", "41\n");
  EXPECT_TRUE(check_config(*config));
  EXPECT_EQ(read_text(folder_ / "starts"), "41\n") << "a check counts no start";
  write("starts", "forty-one\n");
  EXPECT_THAT(check_config(*config).error().message,
              StartsWith("can.secoc.starts_file: " + (folder_ / "starts").string() +
                         ": found 9 bytes that are no number of starts, wanted one whole number"));
}

TEST_F(GoodFilesTest, TheFoldersOfWrittenFilesAreLookedFor) {
  auto config = load_good();
  ASSERT_TRUE(config) << config.error().message;
  const std::filesystem::path in_a_file = folder_ / "town.osm" / "file";
  config->can.secoc = SecocConfig{folder_ / "secoc.key", in_a_file};
  const auto expect_no_folder = [&](const std::string& key, const std::filesystem::path& file) {
    const Status checked = check_config(*config);
    ASSERT_FALSE(checked) << file;
    EXPECT_THAT(checked.error().message,
                StartsWith(key + ": " + file.string() + ": found no folder " +
                           file.parent_path().string()));
  };
  expect_no_folder("can.secoc.starts_file", in_a_file);
  const std::filesystem::path in_no_folder = folder_ / "new" / "file";
  config->can.secoc->starts_file = in_no_folder;
  expect_no_folder("can.secoc.starts_file", in_no_folder);
  config->can.secoc->starts_file = folder_ / "starts";
  EXPECT_TRUE(check_config(*config));
  for (const std::filesystem::path& file : {in_a_file, in_no_folder}) {
    config->learned_calibration_file = file;
    expect_no_folder("calibration.online.file", file);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "new")) << "a check writes nothing";
  config->learned_calibration_file = folder_ / "sub";
  EXPECT_THAT(check_config(*config).error().message,
              StartsWith("calibration.online.file: " + (folder_ / "sub").string() +
                         ": found a folder or a device, wanted a file to replace, or none"));
}

TEST_F(GoodFilesTest, SystemdCreatesTheFolderOfTheDaemon) {
  if (std::filesystem::exists("/var/lib/bevloc")) GTEST_SKIP() << "bevloc is installed here";
  auto config = load_good();
  ASSERT_TRUE(config) << config.error().message;
  config->learned_calibration_file = "/var/lib/bevloc/calibration.yaml";
  EXPECT_TRUE(check_config(*config));
}

/// Files whose model is the shipped one with some changed bytes. The daemon would refuse it, or end
/// in FAULT.
class ChangedModelTest : public GoodFilesTest {
 protected:
  void SetUp() override {
    config_ = load_good();
    ASSERT_TRUE(config_) << config_.error().message;
    bytes_ = read_text(config_->model_file);
  }

  /// The first byte of the value that the model's metadata have for this key.
  char& metadata_value(const std::string& key) {
    const size_t position = bytes_.find(key);
    EXPECT_NE(position, std::string::npos) << key;
    size_t value = position + key.size() + 1;                            // behind the value's tag
    while ((static_cast<uint8_t>(bytes_[value]) & 0x80U) != 0) ++value;  // its length is a varint
    return bytes_[value + 1];
  }

  /// The error message of the check of the changed model.
  std::string message() {
    write("sub/model.onnx", bytes_);
    const Status checked = check_config(*config_);
    return checked ? "" : checked.error().message;
  }

  Result<evaluation::DriveConfig> config_ = fail("not loaded yet");
  std::string bytes_;
  const std::string place_ = "model.file: " + (folder_ / "sub/model.onnx").string() + ": ";
};

TEST_F(ChangedModelTest, TheShippedModelIsGood) {
  EXPECT_EQ(message(), "");
}

TEST_F(ChangedModelTest, ReadsTheStoredAnswer) {
  metadata_value(std::string(kAnswerKey)) = 'x';
  EXPECT_THAT(message(), StartsWith(place_ + "metadata 'bevloc.test_frame_answer': found 'x"));
}

TEST_F(ChangedModelTest, ComparesTheStoredAnswer) {
  char& digit = metadata_value(std::string(kAnswerKey));
  digit = digit == '9' ? '1' : '9';
  EXPECT_THAT(message(), StartsWith(place_ + "network: found "));
}

TEST_F(ChangedModelTest, MakesTheSolver) {
  metadata_value("bevloc.solver.gem_omega") = '3';
  EXPECT_THAT(message(), StartsWith("model.file: solver parameter gem_omega: found 3, wanted 1"));
}

TEST(ReadoutWarning, NamesTheCamerasThatDoNotUseIt) {
  std::vector<drivers::CameraDescription> cameras(3);
  for (int camera = 0; camera < 3; ++camera) cameras[static_cast<size_t>(camera)].camera = camera;
  EXPECT_EQ(readout_warning(cameras), "");
  cameras[0].ignores_readout = true;
  cameras[2].ignores_readout = true;
  EXPECT_THAT(readout_warning(cameras),
              testing::AllOf(StartsWith("cameras.readout_ms: "),
                             HasSubstr("front_left, front_right"), HasSubstr("remove the key")));
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
