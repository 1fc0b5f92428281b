// Tests the section `realtime` of the configuration.
#include "firmware/config/realtime_config.h"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace bevloc::firmware {
namespace {

using testing::StartsWith;

/// Returns the configuration and the error message, which is empty without an error.
std::pair<RealtimeConfig, std::string> read_section(const std::string& section) {
  auto yaml = YamlMap::parse(section, "test");
  EXPECT_TRUE(yaml) << yaml.error().message;
  const RealtimeConfig config = read_realtime(*yaml);
  const Status finished = yaml->finish();
  return {config, finished ? "" : finished.error().message};
}

TEST(RealtimeConfig, RequestsNothingByDefault) {
  for (const RealtimeConfig& config : {read_realtime(std::nullopt), read_section("{}").first}) {
    EXPECT_FALSE(config.lock_memory);
    for (const ThreadSettings& thread : {config.capture, config.vision, config.can}) {
      EXPECT_FALSE(thread.fifo_priority);
      EXPECT_TRUE(thread.cpus.empty());
    }
  }
}

TEST(RealtimeConfig, EveryKeyIsRead) {
  const auto [config, error] = read_section(
      "{lock_memory: true, capture: {fifo_priority: 20}, vision: {cpus: [0]}, "
      "can: {fifo_priority: 49, cpus: [0]}}");
  EXPECT_EQ(error, "");
  EXPECT_TRUE(config.lock_memory);
  EXPECT_EQ(config.capture.fifo_priority, 20);
  EXPECT_TRUE(config.capture.cpus.empty());
  EXPECT_FALSE(config.vision.fifo_priority);
  EXPECT_EQ(config.vision.cpus, std::vector{0});
  EXPECT_EQ(config.can.fifo_priority, 49);
  EXPECT_EQ(config.can.cpus, std::vector{0});
}

TEST(RealtimeConfig, NamesTheKeyOfEachMistake) {
  const long cpus = sysconf(_SC_NPROCESSORS_CONF);
  const std::string no_cpu = std::to_string(cpus);
  const std::string last_cpu = std::to_string(cpus - 1);
  const std::vector<std::pair<std::string, std::string>> mistakes = {
      {"{lock_memory: 1}", "lock_memory: found 1, wanted"},
      {"{locked: true}", "locked: "},
      {"{supervisor: {cpus: [0]}}", "supervisor: "},
      {"{can: {priority: 1}}", "can.priority: "},
      {"{can: {fifo_priority: 0}}", "can.fifo_priority: found 0, wanted a whole number, 1 to 49"},
      {"{can: {fifo_priority: 50}}", "can.fifo_priority: found 50, wanted"},
      {"{vision: {cpus: 0}}", "vision.cpus: found 0, wanted a list"},
      {"{vision: {cpus: []}}", "vision.cpus: found an empty list, wanted one CPU or more"},
      {"{capture: {cpus: [0, 0]}}", "capture.cpus: found a CPU listed twice, wanted each CPU once"},
      {"{capture: {cpus: [0, " + no_cpu + "]}}",
       "capture.cpus[1]: found " + no_cpu + ", wanted a whole number, 0 to " + last_cpu},
      {"{capture: {cpus: [-1]}}", "capture.cpus[0]: found -1, wanted"},
  };
  for (const auto& [section, wanted] : mistakes) {
    EXPECT_THAT(read_section(section).second, StartsWith("test:1: " + wanted)) << section;
  }
}

}  // namespace
}  // namespace bevloc::firmware
