#include "firmware/config/vehicle_bus_config.h"

#include <algorithm>
#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "can/dbc/dbc.h"
#include "firmware/devices/can_bus.h"
#include "tests/firmware/config/config_fixture.h"

namespace bevloc::firmware {
namespace {

/// The section `can` of config/demo_own_bus.yaml in a configuration of its own.
class VehicleBusConfigTest : public ConfigTest {
 protected:
  VehicleBusConfigTest() {
    std::filesystem::copy_file(kSource / "config/vehicle_demo.dbc", folder_ / "vehicle_demo.dbc");
    const std::string demo = read_text(kSource / "config/demo_own_bus.yaml");
    const size_t begin = demo.find("can:\n");
    section_ = demo.substr(begin, demo.find("log:\n") - begin);
  }

  /// Loads the section with `from`, which occurs in it, replaced by `to`.
  Result<evaluation::DriveConfig> load_with(const std::string& from, const std::string& to) const {
    std::string section = section_;
    const size_t position = section.find(from);
    EXPECT_NE(position, std::string::npos) << from;
    return load(with("can: {driver: mock}\n", section.replace(position, from.size(), to)));
  }
  std::string error_with(const std::string& from, const std::string& to) const {
    const auto config = load_with(from, to);
    return config ? "" : config.error().message;
  }

  std::string section_;
};

TEST_F(VehicleBusConfigTest, BindsTheSignals) {
  const auto config = load_with("mock", "mock");
  ASSERT_TRUE(config) << config.error().message;
  ASSERT_TRUE(config->can.vehicle);
  const can::VehicleBinding& binding = *config->can.vehicle;
  EXPECT_EQ(can::ids_of(binding), (std::vector<uint32_t>{288, 289, 291, 290, 292, 293}));
  EXPECT_EQ(binding.wheels.wheels.size(), 4U);
  EXPECT_NEAR(binding.signals[0].factor, 1.0 / 3.6, 1e-12);
  EXPECT_TRUE(binding.yaw_rate.positive_right);
  EXPECT_EQ(binding.wheels.backward->values, std::vector<int64_t>{1}) << "R in VAL_";
  EXPECT_EQ(binding.gnss->valid->values, (std::vector<int64_t>{3, 4}));
  EXPECT_EQ(binding.messages[0].protection.checksum, can::ChecksumKind::kCrc8Sae);
  EXPECT_EQ(binding.messages[0].protection.highest_counter, 14);
  EXPECT_EQ(binding.messages[1].protection.checksum, can::ChecksumKind::kE2eP02)
      << "from the attribute E2EProfile";
  EXPECT_EQ(binding.messages[1].protection.data_ids, std::vector<uint16_t>{77});
  EXPECT_EQ(can::warnings_of(binding).size(), 8U) << "four messages without protection";
}

/// A socket for classic frames would never receive them.
TEST_F(VehicleBusConfigTest, LongMessagesNeedAnFdInterface) {
  auto config = load_with("mock", "mock");
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_FALSE(appliance_options(config->can).fd);
  config->can.vehicle->messages[2].length = 12;
  EXPECT_TRUE(appliance_options(config->can).fd);
}

/// Consumers take both variants, so a second localizer of the other variant must be noticed.
TEST(ApplianceOptionsTest, TheFilterPassesTheIdentifiersOfBothVariants) {
  CanConfig config;
  for (const can::FrameFormat variant : {can::FrameFormat::kClassic, can::FrameFormat::kFd}) {
    config.variant = variant;
    const auto options = appliance_options(config);
    for (const uint32_t id : {0x500U, 0x504U, 0x509U, 0x50BU, 0x50EU}) {
      EXPECT_EQ(std::ranges::count(options.reserved_ids, id), 1) << id;
      EXPECT_EQ(std::ranges::count(options.accepted_ids, id), 0) << "no input: " << id;
    }
  }
}

/// As in a DBC file whose speeds have an offset, but are magnitudes.
TEST_F(VehicleBusConfigTest, SpeedsWhoseRangeBeginsAtZeroHaveNoSign) {
  std::string dbc = read_text(folder_ / "vehicle_demo.dbc");
  dbc = std::regex_replace(dbc, std::regex(R"((SG_ W[RF]_(?:Left|Right) .*,)0\) \[.*\])"),
                           "$1-60) [0|250]");
  ASSERT_NE(dbc.find("-60) [0|250]"), std::string::npos);
  write("vehicle_demo.dbc", dbc);
  EXPECT_NE(error_with("      backward: {signal: TCU_Gear.GE_Position, values: [R]}\n", "")
                .find("found speeds that do not reach -1 m/s"),
            std::string::npos);
}

/// Otherwise a vehicle that reverses would seem to drive forward.
TEST_F(VehicleBusConfigTest, SpeedsAndYawRatesNeedASign) {
  EXPECT_NE(error_with("      backward: {signal: TCU_Gear.GE_Position, values: [R]}\n", "")
                .find("can.vehicle.wheel_speed.signals: found speeds that do not reach -1 m/s, "
                      "wanted the key backward, which names the signal that says when the vehicle "
                      "reverses"),
            std::string::npos);
  std::string dbc = read_text(folder_ / "vehicle_demo.dbc");
  const auto replace = [&dbc](const std::string& from, const std::string& to) {
    ASSERT_NE(dbc.find(from), std::string::npos) << from;
    dbc.replace(dbc.find(from), from.size(), to);
  };
  replace("16|32@1- (1,0) [0|0]", "16|32@1+ (1E-006,0) [0|0]");
  replace("SIG_VALTYPE_ 290 MO_YawRate : 1;\n", "");
  write("vehicle_demo.dbc", dbc);
  EXPECT_NE(error_with("mock", "mock")
                .find("can.vehicle.yaw_rate.signal: found a yaw rate that does not reach -0.3"),
            std::string::npos);
}

TEST_F(VehicleBusConfigTest, NamesWhatWasProbablyMeant) {
  EXPECT_EQ(error_with("message: ESP_Motion", "message: ESP_Motoin"),
            place(22) +
                "can.vehicle.yaw_rate.message: found ESP_Motoin (did you mean ESP_Motion?), "
                "wanted the name of a message of " +
                (folder_ / "vehicle_demo.dbc").string());
  EXPECT_NE(error_with("rear_left: WR_Left", "rear_left: WR_left2")
                .find("can.vehicle.wheel_speed.signals.rear_left: found WR_left2 (did you mean "
                      "WR_Left?), wanted the name of a signal of message ESP_WheelsRear"),
            std::string::npos);
  EXPECT_NE(error_with("FIX_3D, RTK", "FIX_3").find("found FIX_3 (did you mean FIX_3D?)"),
            std::string::npos);
}

TEST_F(VehicleBusConfigTest, NamesTheKeyThatIsWrong) {
  EXPECT_NE(error_with("FIX_3D, RTK", "FIX_3").find("can.vehicle.gnss.valid.values: found FIX_3"),
            std::string::npos);
  EXPECT_NE(error_with("highest_counter: 14", "highest_counter: 200")
                .find("protection[0].highest_counter: found highest counter 200, wanted at most"),
            std::string::npos);
  EXPECT_NE(error_with("checksum: WR_Checksum", "checksum: WR_Checksun")
                .find("protection[0].checksum: found WR_Checksun (did you mean"),
            std::string::npos);
  EXPECT_NE(error_with("        algorithm: crc8_sae_j1850",
                       "        algorithm: crc8_sae_j1850\n        data_id: 300")
                .find("protection[0].data_id: found data id 300, wanted at most 255"),
            std::string::npos);
  EXPECT_NE(error_with("counter: WR_Counter", "counter: ''").find("protection[0].counter: found"),
            std::string::npos);
  EXPECT_NE(error_with("        counter: WR_Counter\n", "")
                .find("protection[0].highest_counter: found highest_counter without a counter"),
            std::string::npos);
}

TEST_F(VehicleBusConfigTest, RefusesWrongUnitsRangesAndCycles) {
  EXPECT_NE(error_with("signal: MO_YawRate ", "signal: MO_Accel ")
                .find("found MO_Accel with unit \"m/s2\", wanted rad/s or deg/s"),
            std::string::npos);
  EXPECT_NE(error_with("rear_right: WR_Right", "rear_right: WR_Valid").find("with unit \"\""),
            std::string::npos);
  EXPECT_NE(error_with("latitude: GP_Latitude", "latitude: GP_Latitude\n      position_unit: km")
                .find("found GP_Latitude with unit \"km\", wanted deg, rad or arcmin"),
            std::string::npos);
  EXPECT_NE(error_with("        algorithm: crc8_sae_j1850",
                       "        algorithm: crc8_sae_j1850\n        cycle_ms: 100")
                .find("found message ESP_WheelsRear with a cycle of 100 ms, wanted 1 to 40 ms for "
                      "odometry"),
            std::string::npos);
}

TEST_F(VehicleBusConfigTest, RefusesWhatBevlocCannotReceive) {
  EXPECT_NE(error_with("message: GPS_Position", "message: DIAG_Extended").find("29-bit identifier"),
            std::string::npos);
  EXPECT_NE(error_with("  driver: mock\n", "  driver: mock\n  localizer_base_id: 0x120\n")
                .find("can.vehicle.dbc: found message ESP_WheelsRear with identifier 0x120 of "
                      "LOC_Status"),
            std::string::npos);
}

/// Its message says itself what was found and wanted.
TEST_F(VehicleBusConfigTest, PassesTheMistakeOfTheDbcFileOn) {
  EXPECT_EQ(error_with("dbc: vehicle_demo.dbc", "dbc: no.dbc"),
            can::read_dbc_file(folder_ / "no.dbc").error().message);
  const std::string dbc = read_text(folder_ / "vehicle_demo.dbc");
  write("vehicle_demo.dbc", dbc + "VAL_ 288 WR_Deleted 1 \"ON\" ;\n");
  EXPECT_EQ(error_with("mock", "mock"),
            (folder_ / "vehicle_demo.dbc").string() + ":" +
                std::to_string(std::ranges::count(dbc, '\n') + 1) +
                ": found WR_Deleted, wanted the name of a signal of message ESP_WheelsRear");
}

TEST_F(VehicleBusConfigTest, WantsOneStatementOfEachFact) {
  EXPECT_NE(error_with("      sigma: GPS", "      sigma_m: 2\n      sigma: GPS")
                .find("found 2 statements of the position's sigma"),
            std::string::npos);
  EXPECT_NE(
      error_with("        rear_left: WR_Left\n", "").find("rear_left and rear_right, or vehicle"),
      std::string::npos);
  EXPECT_NE(error_with("checksum: WR_Checksum", "checksum: WR_Counter").find("wanted a whole byte"),
            std::string::npos);
}

}  // namespace
}  // namespace bevloc::firmware
