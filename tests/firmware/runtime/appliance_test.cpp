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
  const auto warns_of = [&](double learned_rad, bool enabled) {
    LearnedCalibration learned;
    learned.rig_crc32 = rig_crc32(rig);
    learned.errors.setConstant(learned_rad);
    learned.covariance = 1e-6 * ExtrinsicCovariance::Identity();
    EXPECT_TRUE(save_learned(learned, config.learned_calibration_file));
    config.online_calibration.enabled = enabled;
    Hardware hardware;
    hardware.bus = wire.connect();
    hardware.clock = &clock;
    const LogCapture log;
    const auto appliance = Appliance::create(config, rig, map, std::move(hardware));
    EXPECT_TRUE(appliance) << appliance.error().message;
    return log.text().find("warning: ") != std::string::npos;
  };
  const double beyond_rad = 2.0 * config.online_calibration.max_rotation_rad;
  EXPECT_TRUE(warns_of(beyond_rad, true));
  EXPECT_FALSE(warns_of(beyond_rad, false));
  EXPECT_FALSE(warns_of(0.0, true));
  EXPECT_FALSE(warns_of(0.0, false));
}

}  // namespace
}  // namespace bevloc::firmware
