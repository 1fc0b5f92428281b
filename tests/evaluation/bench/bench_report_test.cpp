#include "evaluation/bench/bench_report.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace bevloc::bench {
namespace {

using testing::HasSubstr;
using testing::Not;

/// 2 ms of convolutions at half the peak, 1 ms of copying, and 1 ms that is unattributed.
BenchResult example() {
  BenchResult result;
  result.model = "nano";
  result.frames = 20;
  result.places = 4;
  result.processor = "a processor";
  result.instruction_set = "avx512_core_vnni";
  result.peak = {400e9, 300e9, 10e9};
  result.allocations_counted = true;
  result.stages = {
      {"network-images", true, {0.4e9, 1e6}, {2.0, 2.5, 3.0, 4.0}, 0.5},
      {"images-rgb24", true, {0.0, 5e6}, {1.0, 1.1, 1.2, 1.3}, 0.0},
      {"mjpeg-decode", false, {0.0, 8e6}, {9.0, 9.0, 9.0, 9.0}, 6.0},
  };
  result.whole_frame = StageResult{"whole frame", true, {}, {4.0, 5.0, 6.0, 7.0}, 0.5};
  result.memory = {40.0, 3.0, 20.0, 60.0, {150.0, 170.0}};
  return result;
}

TEST(BenchReport, SumsOnlyTheStagesOfTheFrame) {
  const BenchResult result = example();
  EXPECT_DOUBLE_EQ(result.sum_of_stages_ms(), 3.0);
  EXPECT_DOUBLE_EQ(result.outside_ms(), 1.0);
  EXPECT_DOUBLE_EQ(result.sum_of_ideals_ms(), 1.0 + 0.5);
  EXPECT_DOUBLE_EQ(result.memory.daemon_mib(), 63.0);
}

TEST(BenchReport, JsonHasTheDocumentedKeys) {
  const auto json = nlohmann::json::parse(to_json(example()));
  for (const char* key : {"model", "frames", "threads", "places", "processor", "instruction_set",
                          "peak", "memory", "stages", "frame"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_DOUBLE_EQ(json["peak"]["gmac_per_s"], 400.0);
  EXPECT_DOUBLE_EQ(json["peak"]["copy_gb_per_s"], 10.0);
  EXPECT_DOUBLE_EQ(json["memory"]["daemon_mib"], 63.0);
  const auto& network = json["stages"][0];
  EXPECT_EQ(network["name"], "network-images");
  EXPECT_EQ(network["in_frame"], true);
  EXPECT_DOUBLE_EQ(network["p99_ms"], 3.0);
  EXPECT_DOUBLE_EQ(network["gmac_per_s"], 200.0);
  EXPECT_DOUBLE_EQ(network["share_of_peak"], 0.5);
  EXPECT_DOUBLE_EQ(network["ideal_ms"], 1.0);
  EXPECT_DOUBLE_EQ(network["allocations"], 0.5);
  EXPECT_DOUBLE_EQ(json["frame"]["outside_ms"], 1.0);
  EXPECT_DOUBLE_EQ(json["frame"]["times_ideal"], 4.0 / 1.5);
}

TEST(BenchReport, MarksUnknownValues) {
  BenchResult result = example();
  result.allocations_counted = false;
  result.whole_frame.reset();
  result.peak.convolution_macs_per_s = result.peak.matmul_macs_per_s = 0.0;
  const auto json = nlohmann::json::parse(to_json(result));
  EXPECT_TRUE(json["stages"][0]["allocations"].is_null());
  EXPECT_DOUBLE_EQ(json["stages"][0]["share_of_peak"], 0.0);
  EXPECT_FALSE(json.contains("frame"));
  EXPECT_THAT(table_of(result), Not(HasSubstr("whole frame")));
  EXPECT_DOUBLE_EQ(result.outside_ms(), 0.0);
}

void expect_narrow(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
}

TEST(BenchReport, TableFitsATerminal) {
  BenchResult result = example();
  result.stages[0].time = {1234.567, 1234.567, 1234.567, 1234.567};
  result.stages[0].work = {99'999e6, 999e6};
  expect_narrow(table_of(result));
}

TEST(BenchReport, TableHasTheSumsAfterTheStagesOfTheFrame) {
  const std::string table = table_of(example());
  EXPECT_THAT(table, HasSubstr("whole frame        4.000"));
  EXPECT_THAT(table, HasSubstr("2.67 times"));
  EXPECT_THAT(table, HasSubstr("outside the frame\nmjpeg-decode"));
}

TEST(BenchReport, SweepHasNamedColumns) {
  const SweepResult sweep{"map", "About it.", {"road_km", "crop_ms"}, {{1.0, 0.25}, {10.0, 0.5}}};
  const auto json = nlohmann::json::parse(to_json(std::vector{sweep}));
  EXPECT_DOUBLE_EQ(json["sweeps"]["map"][1]["road_km"], 10.0);
  EXPECT_DOUBLE_EQ(json["sweeps"]["map"][1]["crop_ms"], 0.5);
  EXPECT_THAT(table_of(sweep), HasSubstr("0.25"));
  expect_narrow(table_of(sweep));
}

}  // namespace
}  // namespace bevloc::bench
