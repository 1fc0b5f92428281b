// Tests the shipped configuration, and compares docs/configuration.md with the source code.
#include <map>
#include <regex>
#include <set>

#include <gmock/gmock.h>

#include "pipeline/calibration/rig_yaml.h"
#include "sim/faults/fault_table.h"
#include "sim/sim_rig.h"
#include "tests/firmware/config/config_fixture.h"
#include "tests/support/pose_matchers.h"

namespace bevloc::firmware {
namespace {

TEST(ShippedConfig, DemoLoads) {
  const auto config = evaluation::load_drive_config(kSource / "config/demo.yaml");
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->rig_file, kSource / "config/rig_demo.yaml");
  EXPECT_EQ(config->can.driver, CanDriver::kMock);
  ASSERT_TRUE(config->simulation);
}

TEST(ShippedConfig, DemoUsesTheDefaults) {
  const auto config = evaluation::load_drive_config(kSource / "config/demo.yaml");
  ASSERT_TRUE(config) << config.error().message;
  const Config defaults;
  EXPECT_EQ(config->cameras.synchronizer, defaults.cameras.synchronizer);
  EXPECT_EQ(config->cameras.compensate_motion, defaults.cameras.compensate_motion);
  EXPECT_EQ(config->cameras.buffers, defaults.cameras.buffers);
  EXPECT_EQ(config->cameras.rate_hz, defaults.cameras.rate_hz);
  EXPECT_EQ(config->solver, defaults.solver);
  EXPECT_EQ(config->tracker, defaults.tracker);
  EXPECT_EQ(config->health, defaults.health);
}

/// The published figures were measured with these values. Who changes one must measure again.
TEST(ShippedConfig, DefaultsAreThoseOfThePublishedFigures) {
  const Config defaults;
  EXPECT_EQ(defaults.solver.kind, SolverKind::kBandedRefined);
  EXPECT_EQ(defaults.solver.tracking.x_m, (HypothesisAxis{2.0, 0.2}));
  EXPECT_EQ(defaults.solver.tracking.y_m, (HypothesisAxis{1.0, 0.2}));
  EXPECT_EQ(defaults.solver.acquiring.x_m, (HypothesisAxis{4.0, 0.2}));
  EXPECT_EQ(defaults.solver.acquiring.y_m, (HypothesisAxis{3.0, 0.2}));
  EXPECT_EQ(defaults.tracker.correlation.match_m, Eigen::Vector3d(5.0, 10.0, 10.0));
  EXPECT_EQ(defaults.cameras.synchronizer.min_cameras, 3);
  EXPECT_EQ(defaults.health.yaw_sigma_rad, radians(0.75));
  EXPECT_EQ(defaults.tracker.gate_squared_distance, 21.1);
}

TEST(ShippedConfig, DemoRigIsTheSimulatedOne) {
  const auto rig = read_rig(kSource / "config/rig_demo.yaml");
  ASSERT_TRUE(rig) << rig.error().message;
  const Rig nominal = sim::nominal_rig();
  for (int i = 0; i < kCameraCount; ++i) {
    const CameraModel& shipped = rig->cameras[i];
    const CameraModel& simulated = nominal.cameras[i];
    EXPECT_THAT(shipped.vehicle_from_camera,
                test::RigidTransformNear(simulated.vehicle_from_camera, 1e-7, 1e-7));
    EXPECT_EQ(shipped.intrinsics.width_px, simulated.intrinsics.width_px);
    EXPECT_EQ(shipped.intrinsics.height_px, simulated.intrinsics.height_px);
    EXPECT_NEAR(shipped.intrinsics.fx_px, simulated.intrinsics.fx_px, 1e-6);
    EXPECT_NEAR(shipped.intrinsics.cx_px, simulated.intrinsics.cx_px, 1e-6);
    EXPECT_NEAR(shipped.intrinsics.cy_px, simulated.intrinsics.cy_px, 1e-6);
    EXPECT_NEAR(shipped.intrinsics.k1, simulated.intrinsics.k1, 1e-9);
  }
}

/// All words that the first group of `pattern` captures in a text.
std::set<std::string> captured(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::set<std::string> words;
  for (std::sregex_iterator match(text.begin(), text.end(), regex), end; match != end; ++match) {
    words.insert((*match)[1].str());
  }
  return words;
}

/// The keys that the source code reads. A key is an argument of a reading function, so a word after
/// a parenthesis or a comma. The arguments of reject() after the key are words of a message.
std::set<std::string> keys_in_source() {
  std::string source = read_text(kSource / "evaluation/drive/drive_config.cpp") +
                       read_text(kSource / "evaluation/drive/fault_config.cpp");
  for (const auto& file : std::filesystem::directory_iterator(kSource / "firmware/config")) {
    if (file.path().extension() == ".cpp") source += read_text(file.path());
  }
  const std::regex rejection(R"re(\breject\w*\([^;]*;)re");
  return captured(std::regex_replace(source, rejection, ""), R"re([(,]\s*"([a-z][a-z0-9_]*)")re");
}

TEST(ConfigurationPage, DescribesEveryKeyAndNoOther) {
  const std::string page = read_text(kSource / "docs/configuration.md");
  std::set<std::string> described = captured(page, R"(\n\| `(\w+)` \|)");
  described.merge(captured(page, R"(\n## `(\w+)`)"));
  const std::set<std::string> keys = keys_in_source();
  EXPECT_GT(keys.size(), 50U);
  EXPECT_EQ(described, keys);
}

/// The first two cells of a row: a kind of fault and the keys of its amounts.
std::map<std::string, std::set<std::string>> faults_of_page(const std::string& page) {
  const std::regex row(R"re(\n\| `(\w+)` \|([^|]*)\|)re");
  std::map<std::string, std::set<std::string>> faults;
  for (std::sregex_iterator match(page.begin(), page.end(), row), end; match != end; ++match) {
    faults[(*match)[1].str()] = captured((*match)[2].str(), "`([a-z_]+)`");
  }
  return faults;
}

TEST(SimulationPage, DescribesEveryKindOfFaultWithItsAmounts) {
  std::map<std::string, std::set<std::string>> kinds;
  for (const sim::FaultKindInfo& info : sim::fault_kinds()) {
    std::set<std::string>& amounts = kinds[std::string(info.name)];
    for (const sim::AmountInfo& amount : info.amounts) amounts.emplace(amount.key);
  }
  EXPECT_EQ(faults_of_page(read_text(kSource / "docs/simulation.md")), kinds);
}

}  // namespace
}  // namespace bevloc::firmware
