// The messages about mistakes in a configuration.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/firmware/config/config_fixture.h"

namespace bevloc::firmware {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class ConfigMistakesTest : public ConfigTest {
 protected:
  struct Mistake {
    std::string yaml;
    int line;
    std::string wanted;
  };

  /// Checks that the message of each mistake names file, line and key.
  void expect_named(const std::vector<Mistake>& mistakes) const {
    for (const Mistake& mistake : mistakes) {
      EXPECT_THAT(error_of(mistake.yaml),
                  AllOf(StartsWith(place(mistake.line)), HasSubstr(mistake.wanted)))
          << mistake.yaml;
    }
  }
};

TEST_F(ConfigMistakesTest, UnknownRepeatedAndMisspeltKeysAreNamed) {
  const std::string rate = "  rate_hz: 10\n";
  expect_named({
      {with(rate, rate + "  colour: red\n"), 4, "cameras.colour"},
      {kSmallest + "extra: 1\n", 9, "extra"},
      {with(rate, rate + "  rate_hz: 10\n"), 4, "cameras.rate_hz"},
      {with(rate, "  rate_ms: 100\n"), 1, "cameras.rate_hz"},
      {with(rate, rate + "  wait_s: 1\n"), 4, "cameras.wait_s"},
  });
}

TEST_F(ConfigMistakesTest, WrongTypesAndWordsAreNamed) {
  const std::string rate = "  rate_hz: 10\n";
  expect_named({
      {with(rate, "  rate_hz: fast\n"), 3, "cameras.rate_hz: found fast"},
      {with(rate, "  rate_hz: \"10\"\n"), 3, "cameras.rate_hz"},
      {with(rate, rate + "  min_cameras: 2.5\n"), 4, "cameras.min_cameras"},
      {with(rate, rate + "  compensate_motion: 1\n"), 4, "cameras.compensate_motion"},
      {with("{driver: mock}", "mock"), 7, "can: found mock, wanted a mapping"},
      {with("mock\n", "webcam\n"), 2, "cameras.driver: found webcam, wanted"},
      {kSmallest + "log: {level: loud}\n", 9, "log.level: found loud"},
  });
}

TEST_F(ConfigMistakesTest, WrongCamerasMapsAndBusesAreNamed) {
  const std::string rate = "  rate_hz: 10\n";
  expect_named({
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
  });
}

TEST_F(ConfigMistakesTest, WrongRangesOfTheSolverAreNamed) {
  expect_named({
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
  });
}

TEST_F(ConfigMistakesTest, LimitsThatDeclareAnyPoseValidAreNamed) {
  expect_named({
      {kSmallest + "health: {degraded_after_ms: 500, lost_after_ms: 400}\n", 9,
       "health.lost_after_ms"},
      {kSmallest + "health: {max_longitudinal_sigma_m: 1.5}\n", 9,
       "health.max_longitudinal_sigma_m: found 1.5, wanted a number, 0.01 to 1.4"},
      {kSmallest + "health: {max_lateral_sigma_m: 0.6}\n", 9, "health.max_lateral_sigma_m"},
      {kSmallest + "health: {max_yaw_sigma_deg: 2}\n", 9, "health.max_yaw_sigma_deg"},
      {kSmallest + "health: {corrections_to_track: 1}\n", 9, "health.corrections_to_track"},
      {kSmallest + "health: {refusals_to_lose: 101}\n", 9, "health.refusals_to_lose"},
      {kSmallest + "health: {lost_after_ms: 10001}\n", 9, "health.lost_after_ms"},
      {kSmallest + "health: {odometry_timeout_ms: 1001}\n", 9, "health.odometry_timeout_ms"},
      {kSmallest + "tracker: {gate_squared_distance: 51}\n", 9, "tracker.gate_squared_distance"},
  });
}

TEST_F(ConfigMistakesTest, KeysOfAnotherDriverAreNamed) {
  const std::string rate = "  rate_hz: 10\n";
  const std::string simulation = "simulation: {seed: 1, duration_s: 5}";
  expect_named({
      {with("driver: mock\n" + rate, "driver: replay\n  recording: r\n"), 5, "map.procedural_seed"},
      {with(simulation + "\n", ""), 1, "simulation"},
  });
}

TEST_F(ConfigMistakesTest, WrongSimulationsAreNamed) {
  const std::string simulation = "simulation: {seed: 1, duration_s: 5}";
  expect_named({
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
  });
}

}  // namespace
}  // namespace bevloc::firmware
