#include <gtest/gtest.h>

#include "tests/firmware/config/config_fixture.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;

/// A configuration with replayed pictures; line 7 is the section `gnss`.
class GnssConfigTest : public ConfigTest {
 protected:
  Result<evaluation::DriveConfig> load_gnss(const std::string& section,
                                            const std::string& can = "driver: mock") const {
    return load(
        "cameras: {driver: replay, recording: pictures}\ncalibration: {rig: rig.yaml}\n"
        "map: {file: map.osm}\nmodel: {file: model.onnx}\n"
        "can: {" +
        can + "}\nlog: {level: info}\ngnss: {" + section + "}\n");
  }
  std::string gnss_error(const std::string& section,
                         const std::string& can = "driver: mock") const {
    const auto config = load_gnss(section, can);
    return config ? "" : config.error().message;
  }
};

TEST_F(GnssConfigTest, ReadsAReceiverWithALatency) {
  const auto config = load_gnss("driver: gpsd, antenna_m: [1.2, -0.3], latency_ms: 90");
  ASSERT_TRUE(config) << config.error().message;
  const GnssConfig& gnss = *config->gnss;
  EXPECT_EQ(gnss.gpsd.address, "127.0.0.1");
  EXPECT_EQ(gnss.gpsd.port, 2947);
  EXPECT_EQ(gnss.gpsd.device, "");
  EXPECT_EQ(gnss.antenna.x_m, 1.2);
  EXPECT_EQ(gnss.antenna.y_m, -0.3);
  EXPECT_EQ(gnss.clock.timing, drivers::FixTiming::kArrival);
  EXPECT_EQ(gnss.clock.latency, milliseconds(90));
  EXPECT_EQ(gnss.clock.latency_sigma, milliseconds(50));
  EXPECT_EQ(gnss.clock.max_age, milliseconds(1000));
  EXPECT_EQ(gnss.min_sigma_m, 0.5);
}

TEST_F(GnssConfigTest, ReadsAReceiverByTheSystemClock) {
  const auto config = load_gnss(
      "driver: gpsd, address: '::1', port: 2950, device: /dev/ttyACM0, antenna_m: [0, 0], "
      "timing: system_clock, max_age_ms: 500, min_sigma_m: 0.02");
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->gnss->gpsd.device, "/dev/ttyACM0");
  EXPECT_EQ(config->gnss->clock.timing, drivers::FixTiming::kSystemClock);
}

TEST_F(GnssConfigTest, RefusesWhatCannotBe) {
  const std::string good = "driver: gpsd, antenna_m: [0, 0], latency_ms: 90";
  EXPECT_EQ(gnss_error("driver: ntrip, antenna_m: [0, 0], latency_ms: 90"),
            place(7) + "gnss.driver: found ntrip, wanted one of gpsd");
  EXPECT_EQ(gnss_error(good + ", address: localhost"),
            place(7) +
                "gnss.address: found localhost, wanted an IP address in numbers, such as "
                "127.0.0.1 or ::1");
  EXPECT_EQ(
      gnss_error(good + ", device: '\"}'"),
      place(7) + "gnss.device: found \"\"}\", wanted the path of a receiver, such as /dev/ttyACM0");
  EXPECT_EQ(gnss_error(good + ", max_age_ms: 90.0"),
            place(7) + "gnss.max_age_ms: found 90.0, wanted a number, 100 to 1900");
  EXPECT_EQ(
      gnss_error("driver: gpsd, antenna_m: [0, 0], latency_ms: 600, max_age_ms: 500"),
      place(7) + "gnss.max_age_ms: found not more than latency_ms, wanted more than latency_ms");
  EXPECT_EQ(gnss_error("driver: gpsd, antenna_m: [0, 0]"),
            place(7) + "gnss.latency_ms: found no such key, wanted a number, 0 to 1000");
  EXPECT_NE(gnss_error(good + ", timing: system_clock"), "") << "a latency that is not used";
}

TEST_F(GnssConfigTest, RefusesUnauthenticatedPositionsBesideSecoc) {
  const std::string can =
      "driver: socketcan, interface: can0, secoc: {key_file: key, starts_file: starts}";
  const std::string section = "driver: gpsd, antenna_m: [0, 0], latency_ms: 90, address: ";
  EXPECT_EQ(gnss_error(section + "127.0.0.1", can), "");
  EXPECT_EQ(gnss_error(section + "192.168.7.1", can),
            place(7) +
                "gnss: found positions over the network, which nobody authenticates, with "
                "can.secoc, wanted gpsd on this machine");
}

TEST_F(GnssConfigTest, ReadsTheSourceOfTime) {
  const std::string gnss = "driver: gpsd, antenna_m: [0, 0], latency_ms: 90}\nclock: {";
  const auto config = load_gnss(gnss + "source: ptp, max_error_ms: 0.5");
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->clock.source, can::TimeSource::kPtp);
  EXPECT_EQ(config->clock.max_error, std::chrono::microseconds(500));
  EXPECT_TRUE(config->can.sends_clock);
  EXPECT_FALSE(load_gnss(gnss + "source: none")->can.sends_clock);
  EXPECT_EQ(load_gnss(gnss + "source: ntp")->clock.max_error, milliseconds(10));
  EXPECT_EQ(gnss_error(gnss + "source: pps"),
            place(8) + "clock.source: found pps, wanted one of none, ntp, ptp, gnss");
  EXPECT_EQ(error_of(kSmallest + "clock: {source: ptp}\n"),
            place(9) +
                "clock: found the clock of this machine with mock cameras, wanted no section "
                "clock, because a simulated drive has a clock of its own");
}

TEST_F(GnssConfigTest, RefusesASimulatedDrive) {
  EXPECT_EQ(error_of(kSmallest + "gnss: {driver: gpsd, antenna_m: [0, 0], latency_ms: 90}\n"),
            place(9) +
                "gnss: found a GNSS receiver with mock cameras, wanted no section gnss, "
                "because a simulated drive has a receiver of its own");
}

}  // namespace
}  // namespace bevloc::firmware
