#include "firmware/config/config.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware/devices/can_bus.h"
#include "tests/firmware/config/config_fixture.h"

namespace bevloc::firmware {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST_F(ConfigTest, SmallestFileHasTheDefaults) {
  const auto config = load(kSmallest);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->cameras.driver, CameraDriver::kMock);
  EXPECT_EQ(config->cameras.synchronizer.tolerance, drivers::SynchronizerConfig{}.tolerance);
  EXPECT_EQ(config->cameras.synchronizer.wait, drivers::SynchronizerConfig{}.wait);
  EXPECT_TRUE(config->cameras.compensate_motion);
  EXPECT_EQ(config->rig_file, folder_ / "rig.yaml");
  EXPECT_EQ(config->model_file, folder_ / "sub/model.onnx");
  EXPECT_EQ(config->simulation->town_seed, 7U);
  EXPECT_EQ(config->health.lost_timeout, HealthLimits{}.lost_timeout);
  EXPECT_DOUBLE_EQ(config->health.yaw_sigma_rad, HealthLimits{}.yaw_sigma_rad);
  EXPECT_EQ(config->solver.tracking.x_m.count(), HypothesisGrid{}.x_m.count());
  EXPECT_EQ(config->solver.tracking.yaw_rad.count(), HypothesisGrid{}.yaw_rad.count());
  ASSERT_TRUE(config->simulation);
  EXPECT_TRUE(config->simulation->faults.empty());
  EXPECT_EQ(config->simulation->exposure_offsets[0], Duration::zero());
}

/// A configuration with replay cameras and this content of the section `gpio`.
std::string replay_with_gpio(const std::string& gpio) {
  return "cameras: {driver: replay, recording: drive}\n"
         "calibration: {rig: rig.yaml}\n"
         "map: {file: town.osm}\n"
         "model: {file: m.onnx}\n"
         "can: {driver: mock}\n"
         "gpio: {" +
         gpio + "}\n";
}

TEST_F(ConfigTest, EveryGpioLineIsReadAndOptional) {
  auto config = load(replay_with_gpio(
      "trigger: {chip: soc, line: 17, rate_hz: 20, pulse_ms: 0.5}, "
      "status_led: {chip: soc, line: LED}, fault: {chip: soc, line: FAULT, active: low}, "
      "ignition: {chip: soc, line: KL15, debounce_ms: 300}"));
  ASSERT_TRUE(config) << config.error().message;
  const GpioConfig& gpio = config->gpio;
  EXPECT_EQ(lines_of(gpio).size(), 4U);
  EXPECT_EQ(to_string(gpio.trigger->address), "soc 17");
  EXPECT_EQ(gpio.trigger->timing.period, std::chrono::milliseconds(50));
  EXPECT_EQ(gpio.trigger->timing.pulse_width, std::chrono::microseconds(500));
  EXPECT_FALSE(gpio.status_led->active_low);
  EXPECT_TRUE(gpio.fault->active_low);
  EXPECT_EQ(gpio.ignition->debounce, std::chrono::milliseconds(300));
  config = load(replay_with_gpio(""));
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_TRUE(lines_of(config->gpio).empty());
}

TEST_F(ConfigTest, NamesTheKeyOfEachGpioMistake) {
  EXPECT_THAT(error_of(replay_with_gpio("fault: {chip: soc}")), HasSubstr("gpio.fault.line"));
  EXPECT_THAT(error_of(replay_with_gpio("fault: {chip: soc, line: A, active: down}")),
              HasSubstr("gpio.fault.active"));
  EXPECT_THAT(error_of(replay_with_gpio("trigger: {chip: soc, line: A}")),
              HasSubstr("gpio.trigger.rate_hz"));
  EXPECT_THAT(
      error_of(replay_with_gpio("trigger: {chip: soc, line: A, rate_hz: 50, pulse_ms: 10}")),
      HasSubstr("gpio.trigger.pulse_ms"));
  EXPECT_THAT(
      error_of(replay_with_gpio("fault: {chip: soc, line: A}, ignition: {chip: soc, line: A}")),
      HasSubstr("gpio.ignition.line"));
  EXPECT_THAT(error_of(replay_with_gpio("horn: {chip: soc, line: A}")), HasSubstr("gpio.horn"));
  EXPECT_THAT(error_of(kSmallest + "gpio: {}\n"),
              HasSubstr("gpio: found GPIO lines with mock cameras"));
}

/// A configuration of real cameras with these keys and a trigger of 30 Hz.
std::string triggered_cameras(const std::string& keys) {
  return "cameras:\n"
         "  driver: v4l2\n"
         "  ids: {front_left: c0, front: c1, front_right: c2, back_left: c3, back: c4, "
         "back_right: c5}\n" +
         keys +
         "calibration: {rig: rig.yaml}\n"
         "map: {file: town.osm}\n"
         "model: {file: m.onnx}\n"
         "can: {driver: socketcan, interface: can0}\n"
         "gpio: {trigger: {chip: soc, line: 17, rate_hz: 30}}\n";
}

TEST_F(ConfigTest, TheToleranceIsLessThanThePeriodOfTheTrigger) {
  EXPECT_EQ(error_of(triggered_cameras("  tolerance_ms: 33\n")), "");
  EXPECT_THAT(
      error_of(triggered_cameras("  tolerance_ms: 40\n")),
      AllOf(StartsWith(place(4)), HasSubstr("cameras.tolerance_ms: found a frame period or more")));
}

TEST_F(ConfigTest, CamerasAreNotSlowerThanTheirTrigger) {
  EXPECT_EQ(error_of(triggered_cameras("  rate_hz: 30\n")), "");
  EXPECT_EQ(error_of(triggered_cameras("  rate_hz: 31\n")), "");
  EXPECT_EQ(error_of(triggered_cameras("  rate_hz: 20\n")),
            place(4) +
                "cameras.rate_hz: found 20 beside 30 in gpio.trigger.rate_hz, wanted no key, "
                "because the trigger sets the rate, or at least the rate of the trigger");
}

const char* const kEverySection =
    "cameras: {driver: mock, rate_hz: 20, buffers: 8, tolerance_ms: 1.5, wait_ms: 40, "
    "min_cameras: 4, compensate_motion: false}\n"
    "calibration: {rig: /etc/rig.yaml}\n"
    "map: {file: town.osm}\n"
    "model: {file: ../m.onnx}\n"
    "solver:\n"
    "  kind: full\n"
    "  tracking: {x_range_m: 3, x_step_m: 0.5, y_range_m: 2, y_step_m: 0.25,\n"
    "             yaw_range_deg: 4, yaw_step_deg: 1}\n"
    "can: {driver: socketcan, interface: can0, variant: fd, localizer_base_id: 0x600, "
    "vehicle_base_id: "
    "0x300, rear_track_m: 1.75,\n"
    "  secoc: {key_file: secoc.key, starts_file: /var/lib/bevloc/starts}}\n"
    "tracker: {longitudinal_noise_m_per_sqrt_m: 0.03, lateral_noise_m_per_sqrt_m: 0.04, "
    "yaw_noise_deg_per_sqrt_s: 0.2, speed_scale_sigma: 0.05, yaw_rate_bias_sigma_degps: 0.5, "
    "gnss_correlation_s: 20, correction_correlation_m: [5, 6, 7], gate_squared_distance: 12}\n"
    "health: {odometry_timeout_ms: 100, gnss_timeout_ms: 2000, degraded_after_ms: 300, "
    "lost_after_ms: 4000, corrections_to_track: 3, refusals_to_lose: 9, "
    "max_longitudinal_sigma_m: 0.5, max_lateral_sigma_m: 0.25, max_yaw_sigma_deg: 1}\n"
    "realtime: {lock_memory: true}\n"
    "log: {level: warning}\n"
    "simulation: {seed: 1, duration_s: 5}\n";

TEST_F(ConfigTest, EverySectionIsRead) {
  const auto config = load(kEverySection);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_DOUBLE_EQ(config->cameras.rate_hz, 20.0);
  EXPECT_EQ(config->cameras.buffers, 8);
  EXPECT_EQ(config->cameras.synchronizer.tolerance, std::chrono::microseconds(1500));
  EXPECT_EQ(config->cameras.synchronizer.wait, std::chrono::milliseconds(40));
  EXPECT_EQ(config->cameras.synchronizer.min_cameras, 4);
  EXPECT_FALSE(config->cameras.compensate_motion);
  EXPECT_EQ(config->rig_file, "/etc/rig.yaml");
  EXPECT_EQ(config->map_file, folder_ / "town.osm");
  EXPECT_EQ(config->solver.tracking.x_m.count(), 13);
  EXPECT_EQ(config->solver.tracking.y_m.count(), 17);
  EXPECT_DOUBLE_EQ(config->solver.tracking.yaw_rad.range, radians(4.0));
  EXPECT_DOUBLE_EQ(config->solver.acquiring.x_m.range, 4.0);
  EXPECT_EQ(config->can.driver, CanDriver::kSocketCan);
  EXPECT_EQ(config->can.interface, "can0");
  EXPECT_EQ(config->can.variant, can::FrameFormat::kFd);
  EXPECT_EQ(config->can.base_ids.localizer, 0x600U);
  EXPECT_EQ(config->can.base_ids.vehicle, 0x300U);
  EXPECT_DOUBLE_EQ(config->can.rear_track_m, 1.75);
  EXPECT_TRUE(config->realtime.lock_memory);
  EXPECT_EQ(config->log_level, LogLevel::kWarning);
  ASSERT_TRUE(config->can.secoc);
  EXPECT_EQ(config->can.secoc->key_file.filename(), "secoc.key");
  EXPECT_EQ(config->can.secoc->starts_file, "/var/lib/bevloc/starts");
}

/// The daemon replaces this file, so the rig would be lost.
TEST_F(ConfigTest, WhatIsLearnedReplacesNoFileThatIsRead) {
  const auto error_with = [this](const std::string& file) {
    return error_of(with("{rig: rig.yaml}", "{rig: rig.yaml, online: {file: " + file + "}}"));
  };
  EXPECT_EQ(error_with("learned.yaml"), "");
  for (const std::string file : {"rig.yaml", "./rig.yaml", "test.yaml", "sub/model.onnx"}) {
    EXPECT_EQ(error_with(file), "calibration.online.file: " + (folder_ / file).string() +
                                    ": found a file to write that is also read, wanted another "
                                    "name for the output");
  }
  write("rig.yaml", "a rig");
  std::filesystem::create_hard_link(folder_ / "rig.yaml", folder_ / "link");
  EXPECT_THAT(error_with("link"), HasSubstr("link: found a file to write that is also"));
}

TEST_F(ConfigTest, WhatIsLearnedDoesNotReplaceTheNumberOfStarts) {
  std::string text = kEverySection;
  const std::string rig = "calibration: {rig: /etc/rig.yaml";
  ASSERT_NE(text.find(rig), std::string::npos);
  text.replace(text.find(rig), rig.size(), rig + ", online: {file: /var/lib/bevloc/starts}");
  EXPECT_THAT(error_of(text), StartsWith("calibration.online.file: /var/lib/bevloc/st"));
}

TEST_F(ConfigTest, TheLogHasADefaultLevel) {
  const auto config = load(kSmallest + "log: {}\n");
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->log_level, LogLevel::kInfo);
}

TEST_F(ConfigTest, TheNameOfTheFaultSocketFitsTheSystem) {
  const auto error_with = [this](size_t length) {
    const std::string name(length, 's');
    return error_of(with("duration_s: 5", "duration_s: 5, fault_socket: " + name));
  };
  EXPECT_EQ(error_with(107), "");
  EXPECT_THAT(error_with(108), StartsWith(place(8) + "simulation.fault_socket: found "));
}

TEST_F(ConfigTest, TrackerAndHealthAreRead) {
  const auto config = load(kEverySection);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_DOUBLE_EQ(config->tracker.motion.longitudinal_m_per_sqrt_m, 0.03);
  EXPECT_DOUBLE_EQ(config->tracker.motion.lateral_m_per_sqrt_m, 0.04);
  EXPECT_DOUBLE_EQ(config->tracker.motion.yaw_rad_per_sqrt_s, radians(0.2));
  EXPECT_DOUBLE_EQ(config->tracker.initial_speed_scale_sigma, 0.05);
  EXPECT_DOUBLE_EQ(config->tracker.initial_yaw_rate_bias_sigma_radps, radians(0.5));
  EXPECT_DOUBLE_EQ(config->tracker.correlation.gnss_s, 20.0);
  EXPECT_EQ(config->tracker.correlation.match_m, Eigen::Vector3d(5.0, 6.0, 7.0));
  EXPECT_DOUBLE_EQ(config->tracker.gate_squared_distance, 12.0);
  EXPECT_EQ(config->health.odometry_timeout, std::chrono::milliseconds(100));
  EXPECT_EQ(config->health.gnss_timeout, std::chrono::milliseconds(2000));
  EXPECT_EQ(config->health.correction_timeout, std::chrono::milliseconds(300));
  EXPECT_EQ(config->health.lost_timeout, std::chrono::milliseconds(4000));
  EXPECT_EQ(config->health.corrections_to_track, 3);
  EXPECT_EQ(config->health.refusals_to_lose, 9);
  EXPECT_DOUBLE_EQ(config->health.longitudinal_sigma_m, 0.5);
  EXPECT_DOUBLE_EQ(config->health.lateral_sigma_m, 0.25);
  EXPECT_DOUBLE_EQ(config->health.yaw_sigma_rad, radians(1.0));
}

TEST_F(ConfigTest, SimulationIsRead) {
  const auto config = load(
      with("simulation: {seed: 1, duration_s: 5}\n",
           "simulation:\n"
           "  seed: 9\n"
           "  duration_s: 12.5\n"
           "  conditions: {sun_azimuth_deg: 90, sun_elevation_deg: -10, rain: 0.5}\n"
           "  calibration_error: {rotation_deg: 1, translation_m: 0.02, relative_focal: 0.01}\n"
           "  exposure_offsets_ms: [0, 12.5, 25, 30, 40, 50]\n"
           "  faults:\n"
           "    - {kind: camera_late, camera: back, from_s: 1, until_s: 2, delay_ms: 40}\n"
           "    - {kind: camera_drop, camera: front, every: 7}\n"
           "    - {kind: camera_swapped, camera: front, with: back}\n"
           "    - {kind: gnss_jump, from_s: 3, across_m: -3.5}\n"));
  ASSERT_TRUE(config) << config.error().message;
  ASSERT_TRUE(config->simulation);
  const evaluation::SimulationConfig& simulation = *config->simulation;
  EXPECT_EQ(simulation.seed, 9U);
  EXPECT_DOUBLE_EQ(simulation.duration_s, 12.5);
  EXPECT_DOUBLE_EQ(simulation.conditions.sun_azimuth_rad, radians(90.0));
  EXPECT_DOUBLE_EQ(simulation.conditions.sun_elevation_rad, radians(-10.0));
  EXPECT_DOUBLE_EQ(simulation.conditions.rain, 0.5);
  EXPECT_DOUBLE_EQ(simulation.conditions.overcast, sim::Conditions{}.overcast);
  EXPECT_DOUBLE_EQ(simulation.calibration_error.rotation_rad, radians(1.0));
  EXPECT_DOUBLE_EQ(simulation.calibration_error.translation_m, 0.02);
  EXPECT_DOUBLE_EQ(simulation.calibration_error.relative_focal, 0.01);
  EXPECT_EQ(simulation.exposure_offsets[1], std::chrono::microseconds(12'500));
  EXPECT_EQ(simulation.exposure_offsets[5], std::chrono::milliseconds(50));
  ASSERT_EQ(simulation.faults.size(), 4U);
  const sim::Fault& late = simulation.faults[0];
  EXPECT_EQ(late.kind, sim::FaultKind::kCameraLate);
  EXPECT_EQ(late.camera, 4);
  EXPECT_DOUBLE_EQ(late.amounts.delay_ms, 40.0);
  EXPECT_DOUBLE_EQ(late.until_s, 2.0);
  EXPECT_DOUBLE_EQ(simulation.faults[1].amounts.every, 7.0);
  EXPECT_EQ(simulation.faults[2].camera, 1);
  EXPECT_EQ(simulation.faults[2].other_camera, 4);
  const sim::Fault& jump = simulation.faults[3];
  EXPECT_EQ(jump.kind, sim::FaultKind::kGnssJump);
  EXPECT_FALSE(jump.camera);
  EXPECT_DOUBLE_EQ(jump.from_s, 3.0);
  EXPECT_TRUE(std::isinf(jump.until_s));
  EXPECT_DOUBLE_EQ(jump.amounts.across_m, -3.5);
  EXPECT_DOUBLE_EQ(jump.amounts.east_m, 0.0);
}

TEST_F(ConfigTest, TheSolverSupportsTheLargestRangesOfTheConfiguration) {
  const auto config = load(kSmallest +
                           "solver: {tracking: {x_range_m: 7.5, x_step_m: 1.5, y_range_m: 7.5, "
                           "y_step_m: 1.5, yaw_range_deg: 20, yaw_step_deg: 5}}\n");
  ASSERT_TRUE(config) << config.error().message;
  const auto solver = make_solver(config->solver.kind, kFeatureGrid, 1, config->solver.tracking,
                                  SolverParameters());
  EXPECT_TRUE(solver) << solver.error().message;
}

TEST_F(ConfigTest, NamesAMissingOrBrokenFile) {
  const auto missing = evaluation::load_drive_config(folder_ / "gone.yaml");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("gone.yaml"));
  EXPECT_THAT(error_of("cameras: [\n"), HasSubstr("test.yaml:"));
  EXPECT_THAT(error_of(""), HasSubstr("test.yaml"));
}

TEST_F(ConfigTest, WithoutTheSimulatorMockCamerasAreRefused) {
  write("test.yaml", kSmallest);
  const auto config = load_config(folder_ / "test.yaml");
  ASSERT_FALSE(config);
  EXPECT_EQ(
      config.error().message,
      place(2) +
          "cameras.driver: found mock, wanted v4l2, libcamera or replay, because this bevlocd "
          "was built without the simulator");
}

TEST(CanBus, TheMockBusIsRefused) {
  const auto bus = open_can_bus(CanConfig());
  ASSERT_FALSE(bus);
  EXPECT_EQ(bus.error().message,
            "can.driver: found mock, which this bevlocd was built without, wanted socketcan");
}

}  // namespace
}  // namespace bevloc::firmware
