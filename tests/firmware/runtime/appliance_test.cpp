// Tests what the appliance does with its files at its start.
#include "firmware/runtime/appliance.h"

#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/map/map_loader.h"
#include "pipeline/online_calibration/calibration_file.h"
#include "tests/firmware/log_capture.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::firmware {
namespace {

TEST(ApplianceTest, WarnsOfLearnedErrorsOnlyIfItUsesThem) {
  const test::TemporaryFolder folder;
  const Rig rig = read_rig(BEVLOC_SOURCE_DIR "/config/rig_demo.yaml").value();
  const HdMap map = load_map(BEVLOC_SOURCE_DIR "/tests/pipeline/map/fixtures/street.osm").value();
  Config config;
  config.model_file = BEVLOC_SOURCE_DIR "/models/nano.onnx";
  config.learned_calibration_file = folder / "learned.yaml";
  drivers::VirtualClock clock;
  can::MockWire wire(16);
  const auto log_of = [&](double learned_rad, double variance, bool enabled) {
    LearnedCalibration learned;
    learned.rig_crc32 = rig_crc32(rig);
    learned.errors.setConstant(learned_rad);
    learned.covariance = variance * ExtrinsicCovariance::Identity();
    EXPECT_TRUE(save_learned(learned, config.learned_calibration_file));
    config.online_calibration.enabled = enabled;
    Hardware hardware;
    hardware.bus = wire.connect();
    hardware.clock = &clock;
    const LogCapture log;
    const auto appliance = Appliance::create(config, rig, map, std::move(hardware));
    EXPECT_TRUE(appliance) << appliance.error().message;
    return log.text();
  };
  constexpr const char* kWarning = "warning: ";
  constexpr double kVariance = 1e-6;
  const double beyond_rad = 2.0 * config.online_calibration.max_rotation_rad;
  const std::string beyond = log_of(beyond_rad, kVariance, true);
  EXPECT_NE(beyond.find("beyond their bounds"), std::string::npos) << beyond;
  const std::string indefinite = log_of(0.0, -kVariance, true);
  EXPECT_NE(indefinite.find("not positive definite"), std::string::npos) << indefinite;
  EXPECT_EQ(log_of(beyond_rad, kVariance, false).find(kWarning), std::string::npos);
  EXPECT_EQ(log_of(0.0, kVariance, true).find(kWarning), std::string::npos);
  EXPECT_EQ(log_of(0.0, kVariance, false).find(kWarning), std::string::npos);
}

}  // namespace
}  // namespace bevloc::firmware
