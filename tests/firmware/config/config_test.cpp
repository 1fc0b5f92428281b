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

TEST_F(ConfigTest, EverySectionIsRead) {
  const auto config = load(
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
      "simulation: {seed: 1, duration_s: 5}\n");
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
  ASSERT_TRUE(config->can.secoc);
  EXPECT_EQ(config->can.secoc->key_file.filename(), "secoc.key");
  EXPECT_EQ(config->can.secoc->starts_file, "/var/lib/bevloc/starts");
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
  EXPECT_TRUE(config->realtime.lock_memory);
  EXPECT_EQ(config->log_level, LogLevel::kWarning);
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

TEST_F(ConfigTest, NamesFileLineAndKeyOfEachMistake) {
  struct Mistake {
    std::string yaml;
    int line;
    std::string wanted;
  };
  const std::string rate = "  rate_hz: 10\n";
  const std::string simulation = "simulation: {seed: 1, duration_s: 5}";
  const std::vector<Mistake> mistakes = {
      // unknown, repeated and misspelt keys
      {with(rate, rate + "  colour: red\n"), 4, "cameras.colour"},
      {kSmallest + "extra: 1\n", 9, "extra"},
      {with(rate, rate + "  rate_hz: 10\n"), 4, "cameras.rate_hz"},
      {with(rate, "  rate_ms: 100\n"), 1, "cameras.rate_hz"},
      {with(rate, rate + "  wait_s: 1\n"), 4, "cameras.wait_s"},
      // wrong types
      {with(rate, "  rate_hz: fast\n"), 3, "cameras.rate_hz: found fast"},
      {with(rate, "  rate_hz: \"10\"\n"), 3, "cameras.rate_hz"},
      {with(rate, rate + "  min_cameras: 2.5\n"), 4, "cameras.min_cameras"},
      {with(rate, rate + "  compensate_motion: 1\n"), 4, "cameras.compensate_motion"},
      {with("{driver: mock}", "mock"), 7, "can: found mock, wanted a mapping"},
      {with("mock\n", "webcam\n"), 2, "cameras.driver: found webcam, wanted"},
      // out of range, or inconsistent
      {with(rate, "  rate_hz: 0\n"), 3, "cameras.rate_hz: found 0"},
      {with(rate, "  rate_hz: .nan\n"), 3, "cameras.rate_hz"},
      {with(rate, rate + "  min_cameras: 7\n"), 4, "cameras.min_cameras: found 7"},
      {with(rate, rate + "  tolerance_ms: 20\n  wait_ms: 10\n"), 5, "cameras.wait_ms"},
      {with(rate, "  rate_hz: 20\n  tolerance_ms: 50\n"), 4, "cameras.tolerance_ms"},
      {with("procedural_seed: 7", "procedural_seed: 4294967296"), 5, "map.procedural_seed"},
      {with("procedural_seed: 7", "procedural_seed: 7, file: a.osm"), 5, "map.file"},
      {with("{driver: mock}", "{driver: mock, localizer_base_id: 0x7F0}"), 7,
       "can.localizer_base_id"},
      {with("{driver: mock}", "{driver: mock, localizer_base_id: 0x410}"), 7,
       "can.localizer_base_id"},
      {with("{driver: mock}", "{driver: mock, rear_track_m: 0.1}"), 7, "can.rear_track_m"},
      {with("{driver: mock}", "{driver: mock, secoc: {key_file: k, starts_file: s}}"), 7,
       "can.secoc"},
      {with("{driver: mock}", "{driver: mock, interface: can0}"), 7, "can.interface"},
      {with("{driver: mock}", "{driver: socketcan}"), 7, "can.interface"},
      {with("{driver: mock}", "{driver: mock, variant: xl}"), 7, "can.variant"},
      {kSmallest + "solver: {kind: quick}\n", 9, "solver.kind: found quick, wanted one of full, "},
      {kSmallest + "solver: {tracking: {x_range_m: 1, x_step_m: 2}}\n", 9,
       "solver.tracking.x_step_m"},
      {kSmallest + "solver: {tracking: {y_range_m: 0.8, y_step_m: 0.21}}\n", 9,
       "solver.tracking.y_step_m: found more than a quarter of the range"},
      {kSmallest + "solver: {acquiring: {y_range_m: 7.6}}\n", 9,
       "solver.acquiring.y_range_m: found 7.6, wanted a number, 0.1 to 7.5"},
      {kSmallest + "solver:\n  tracking:\n    x_range_m: 7.5\n    x_step_m: 0.2\n", 12,
       "solver.tracking.x_step_m: found 0.2, with which the last of 38 steps is at 7.6, wanted at "
       "most 1000 steps from zero, and none beyond 7.5"},
      {kSmallest + "solver: {acquiring: {yaw_range_deg: 20, yaw_step_deg: 0.01}}\n", 9,
       "solver.acquiring.yaw_step_deg: found 0.01, with which the last of 2000 steps is at 20, "},
      {kSmallest + "solver: {tracking: {x_range_m: 7.5, x_step_m: 0.05, y_range_m: 7.5, y_step_m: "
                   "0.05, yaw_range_deg: 20, yaw_step_deg: 0.1}}\n",
       9,
       "solver.tracking.x_step_m: found 36331001 hypotheses of x, y and yaw in all, wanted at most "
       "1000000"},
      {kSmallest + "health: {degraded_after_ms: 500, lost_after_ms: 400}\n", 9,
       "health.lost_after_ms"},
      // limits that declare any pose valid
      {kSmallest + "health: {max_longitudinal_sigma_m: 1.5}\n", 9,
       "health.max_longitudinal_sigma_m: found 1.5, wanted a number, 0.01 to 1.4"},
      {kSmallest + "health: {max_lateral_sigma_m: 0.6}\n", 9, "health.max_lateral_sigma_m"},
      {kSmallest + "health: {max_yaw_sigma_deg: 2}\n", 9, "health.max_yaw_sigma_deg"},
      {kSmallest + "health: {corrections_to_track: 1}\n", 9, "health.corrections_to_track"},
      {kSmallest + "health: {refusals_to_lose: 101}\n", 9, "health.refusals_to_lose"},
      {kSmallest + "health: {lost_after_ms: 10001}\n", 9, "health.lost_after_ms"},
      {kSmallest + "health: {odometry_timeout_ms: 1001}\n", 9, "health.odometry_timeout_ms"},
      {kSmallest + "tracker: {gate_squared_distance: 51}\n", 9, "tracker.gate_squared_distance"},
      {kSmallest + "log: {level: loud}\n", 9, "log.level: found loud"},
      // keys of another driver
      {with("driver: mock\n" + rate, "driver: replay\n  recording: r\n"), 5, "map.procedural_seed"},
      {with(simulation + "\n", ""), 1, "simulation"},
      {with(simulation, "simulation: {seed: 1, duration_s: 5, stops_s: [7, 2]}"), 8,
       "simulation.stops_s: found 7 to 2, wanted the shortest time first"},
      {with(simulation,
            "simulation: {seed: 1, duration_s: 5, pace: [{at_s: 2, pace: 1}, {at_s: 2, pace: 0}]}"),
       8, "simulation.pace[1].at_s: found 2, wanted a time after that of the point before"},
      {with(simulation, "simulation: {seed: 1, duration_s: 5, exposure_offsets_ms: [1, 2, 3]}"), 8,
       "simulation.exposure_offsets_ms: found a list of 3, wanted a list of 6"},
      {with(simulation,
            "simulation: {seed: 1, duration_s: 5, exposure_offsets_ms: [0, 0, 51, 0, 0, 0]}"),
       8, "simulation.exposure_offsets_ms[2]: found 51"},
      {with(simulation, "simulation: {seed: 1, duration_s: 5, faults: [{kind: gnss, from_s: 1}]}"),
       8, "simulation.faults[0].kind: found gnss, wanted"},
      {with(simulation,
            "simulation: {seed: 1, duration_s: 5, faults: [{kind: camera_dead, camera: left}]}"),
       8, "simulation.faults[0].camera: found left"},
      {with(simulation,
            "simulation: {seed: 1, duration_s: 5, faults: [{kind: camera_dead, every: 3}]}"),
       8, "simulation.faults[0].every"},
      {with(simulation,
            "simulation: {seed: 1, duration_s: 5, faults: [{kind: camera_dead, from_s: 3, until_s: "
            "2}]}"),
       8, "simulation.faults[0].until_s"},
      {with(simulation, "simulation: {seed: 1, duration_s: 5, faults: [{kind: camera_drop}]}"), 8,
       "simulation.faults[0].every"},
      {with(simulation,
            "simulation: {seed: 1, duration_s: 5, faults: [{kind: camera_drop, every: 2.5}]}"),
       8, "simulation.faults[0].every: found 2.5, wanted a whole number"},
      {with(simulation,
            "simulation: {seed: 1, duration_s: 5, faults: [{kind: camera_swapped, camera: back, "
            "with: back}]}"),
       8, "simulation.faults[0].with"},
      {with(simulation,
            "simulation: {seed: 1, duration_s: 5, faults: [{kind: gnss_outage, camera: back}]}"),
       8, "simulation.faults[0].camera"},
      {with(simulation,
            "simulation: {seed: 1, duration_s: 5, faults: [{kind: odometry_lock, factor: 1.5}]}"),
       8, "simulation.faults[0].factor: found 1.5"},
  };
  for (const Mistake& mistake : mistakes) {
    EXPECT_THAT(error_of(mistake.yaml),
                AllOf(StartsWith(place(mistake.line)), HasSubstr(mistake.wanted)))
        << mistake.yaml;
  }
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
