#include "pipeline/online_calibration/calibration_file.h"

#include <filesystem>

#include <gmock/gmock.h>

#include "common/files.h"
#include "pipeline/calibration/rig_yaml.h"

namespace bevloc {
namespace {

using ::testing::HasSubstr;

constexpr uint32_t kRig = 0x12345678;

LearnedCalibration some_calibration() {
  LearnedCalibration learned;
  learned.rig_crc32 = kRig;
  learned.errors.setLinSpaced(-0.01, 0.01 / 3.0);
  learned.covariance = 1e-6 * ExtrinsicCovariance::Identity();
  learned.covariance(3, 7) = learned.covariance(7, 3) = 1e-7 / 3.0;
  return learned;
}

std::filesystem::path file_in_empty_folder(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder / "learned.yaml";
}

TEST(CalibrationFile, KeepsEveryBit) {
  const auto path = file_in_empty_folder("keeps_every_bit");
  ASSERT_TRUE(save_learned(some_calibration(), path).has_value());
  ASSERT_TRUE(save_learned(some_calibration(), path).has_value()) << "replaces the file";
  const auto again = load_learned(path, kRig);
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ(again->errors, some_calibration().errors);
  EXPECT_EQ(again->covariance, some_calibration().covariance);
}

TEST(CalibrationFile, RefusesWhatBelongsToAnotherRig) {
  const auto path = file_in_empty_folder("another_rig");
  ASSERT_TRUE(save_learned(some_calibration(), path).has_value());
  const auto again = load_learned(path, kRig + 1);
  ASSERT_FALSE(again.has_value());
  EXPECT_THAT(again.error().message, HasSubstr("another rig"));
}

TEST(CalibrationFile, RefusesEveryCutAndEveryChangedDigit) {
  const std::string text = format_learned(some_calibration());
  for (size_t length = 0; length + 1 < text.size(); length += 97) {
    EXPECT_FALSE(parse_learned(text.substr(0, length), "cut").has_value()) << length;
  }
  int changed = 0;
  for (size_t i = 0; i < text.size(); i += 13) {
    if (text[i] < '0' || text[i] > '9') continue;
    std::string damaged = text;
    damaged[i] = damaged[i] == '7' ? '8' : '7';
    EXPECT_FALSE(parse_learned(damaged, "damaged").has_value()) << i;
    ++changed;
  }
  EXPECT_GT(changed, 100);
}

TEST(CalibrationFile, NamesTheFolderThatCannotBeWritten) {
  const Status status = save_learned(some_calibration(), "/nonexistent/learned.yaml");
  ASSERT_FALSE(status.has_value());
  EXPECT_THAT(status.error().message, HasSubstr("/nonexistent/learned.yaml"));
}

TEST(CalibrationFile, RigsHaveTheirOwnCrc) {
  const auto path = std::string(BEVLOC_SOURCE_DIR) + "/config/rig_demo.yaml";
  Rig rig = *read_rig(path);
  const uint32_t before = rig_crc32(rig);
  rig.cameras[3].vehicle_from_camera.translation_m.x() += 0.001;
  EXPECT_NE(rig_crc32(rig), before);
}

}  // namespace
}  // namespace bevloc
