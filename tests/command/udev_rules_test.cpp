#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command/init/answers.h"
#include "command/udev/udev_rules_command.h"
#include "common/files.h"
#include "tests/support/command_line.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::command {
namespace {

using testing::HasSubstr;
using testing::Not;

class UdevRulesTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(sysfs_ / "bus/gpio/devices");
    add("gpiochip0", "fe200000.gpio");
    add("gpiochip1", "1-0020");
  }

  /// A chip of a device, as the kernel shows it.
  void add(const std::string& chip, const std::string& device) {
    const auto node = sysfs_ / "devices/platform" / device / chip;
    std::filesystem::create_directories(node);
    std::filesystem::create_directory_symlink(node, sysfs_ / "bus/gpio/devices" / chip);
  }

  test::TemporaryFolder folder_;
  const std::filesystem::path sysfs_ = folder_ / "sys";
  const std::vector<drivers::GpioChipInfo> chips_{
      {"gpiochip0", "pinctrl-bcm2711", {{"TRIGGER", ""}, {"FAULT", ""}}},
      {"gpiochip1", "pca9555", {{"LED", ""}}},
      {"gpiochip2", "without-device", {{"X", ""}}}};
};

TEST_F(UdevRulesTest, NamesTheDeviceOfEachChipOnce) {
  const auto rules = udev_rules(
      chips_, {{"pinctrl-bcm2711", "TRIGGER"}, {"gpiochip0", "1"}, {"pca9555", "LED"}}, sysfs_);
  ASSERT_TRUE(rules) << rules.error().message;
  EXPECT_THAT(*rules, HasSubstr(R"(SUBSYSTEM=="gpio", KERNEL=="gpiochip*", KERNELS=="1-0020", )"
                                R"(GROUP="bevloc", MODE="0660")"));
  const auto first = rules->find("fe200000.gpio");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(rules->find("fe200000.gpio", first + 1), std::string::npos);
}

TEST_F(UdevRulesTest, LeavesOutChipsThatNoLineIsOn) {
  const auto rules = udev_rules(chips_, {{"pca9555", "LED"}}, sysfs_);
  ASSERT_TRUE(rules);
  EXPECT_THAT(*rules, Not(HasSubstr("fe200000")));
}

/// The banks of a pin controller have one parent.
TEST_F(UdevRulesTest, TellsChipsOfOneDeviceApartByTheDeviceTree) {
  add("gpiochip3", "fe200000.gpio");
  std::ofstream(sysfs_ / "bus/gpio/devices/gpiochip0/uevent")
      << "MAJOR=254\nOF_FULLNAME=/soc/pinctrl@fe200000/gpio@0\n";
  const std::vector<drivers::LineAddress> lines{{"pinctrl-bcm2711", "TRIGGER"}};
  const auto rules = udev_rules(chips_, lines, sysfs_);
  ASSERT_TRUE(rules) << rules.error().message;
  EXPECT_THAT(*rules, HasSubstr(R"(KERNELS=="fe200000.gpio", )"
                                R"(ENV{OF_FULLNAME}=="/soc/pinctrl@fe200000/gpio@0", GROUP=)"));
}

TEST_F(UdevRulesTest, NamesChipsThatCannotBeToldApart) {
  add("gpiochip3", "fe200000.gpio/below");
  const std::vector<drivers::LineAddress> lines{{"pinctrl-bcm2711", "TRIGGER"}};
  const auto rules = udev_rules(chips_, lines, sysfs_);
  ASSERT_TRUE(rules) << rules.error().message;
  EXPECT_THAT(
      *rules,
      HasSubstr("# The next rule also opens gpiochip3 to the group: no attribute tells them from"));
}

TEST_F(UdevRulesTest, SaysThatThereIsNoLine) {
  const auto rules = udev_rules(chips_, {}, sysfs_);
  ASSERT_TRUE(rules);
  EXPECT_THAT(*rules, HasSubstr("names no GPIO line"));
  EXPECT_THAT(*rules, Not(HasSubstr("SUBSYSTEM")));
}

TEST_F(UdevRulesTest, RefusesUnknownLinesAndChipsWithoutDevice) {
  const auto unknown = udev_rules(chips_, {{"pca9555", "HORN"}}, sysfs_);
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("found no such line"));
  const auto without = udev_rules(chips_, {{"without-device", "X"}}, sysfs_);
  ASSERT_FALSE(without);
  EXPECT_THAT(without.error().message, HasSubstr("found no device of this chip"));
}

/// Runs the command with a configuration that has this section `gpio`.
Status run_with_gpio(const std::filesystem::path& folder, const std::string& gpio,
                     const std::filesystem::path& out) {
  const std::filesystem::path tree = BEVLOC_SOURCE_DIR;
  const Answers answers{.driver = kV4l2Cameras,
                        .ids = {"a", "b", "c", "d", "e", "f"},
                        .rig = tree / "config/rig_demo.yaml",
                        .map = tree / "tests/pipeline/map/fixtures/street.osm",
                        .model = tree / "models/nano.onnx",
                        .can = "can0"};
  std::ofstream(folder / "bevlocd.yaml") << configuration_text(answers, folder) << gpio;
  return test::run_command<UdevRulesCommand>(
      {"udev-rules", "--config", (folder / "bevlocd.yaml").string(), "--out", out.string()},
      nullptr);
}

TEST(UdevRulesFile, IsWrittenOnSuccessOnly) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "60-bevloc.rules";
  std::ofstream(file) << "rules from before";
  const Status unknown =
      run_with_gpio(folder.path(), "gpio:\n  status_led: {chip: no chip, line: LED}\n", file);
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("found no such GPIO chip"));
  EXPECT_EQ(read_file(file).value(), "rules from before");
  const Status written = run_with_gpio(folder.path(), "", file);
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_THAT(read_file(file).value(), HasSubstr("names no GPIO line"));
}

TEST(UdevRulesFile, IsNotTheConfiguration) {
  const test::TemporaryFolder folder;
  const Status refused = run_with_gpio(folder.path(), "", folder / "bevlocd.yaml");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("is also read"));
}

}  // namespace
}  // namespace bevloc::command
