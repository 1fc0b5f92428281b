// `bevloc bench`: its output and the arguments it refuses. The tests do not check times.
#include "evaluation/bench/bench_command.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "tests/evaluation/own_config.h"
#include "tests/support/command_line.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::bench {
namespace {

using testing::HasSubstr;

constexpr const char* kConfig = BEVLOC_SOURCE_DIR "/config/demo.yaml";

Status run(std::vector<std::string> arguments, const std::string& config = kConfig) {
  arguments.insert(arguments.begin(), {"bench", "--config", config});
  return test::run_command<BenchCommand>(arguments);
}

class BenchCommandTest : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_ / name; }
  nlohmann::json json() const { return nlohmann::json::parse(std::ifstream(file("a.json"))); }

  const test::TemporaryFolder folder_;
};

TEST_F(BenchCommandTest, MeasuresAFrameAndItsStages) {
  const Status status = run({"--frames", "2", "--json", file("a.json")});
  ASSERT_TRUE(status) << status.error().message;
  const auto found = json();
  EXPECT_EQ(found["model"], "nano");
  EXPECT_EQ(found["frames"], 2);
  EXPECT_GT(found["frame"]["p50_ms"], 0.0);
  EXPECT_GE(found["frame"]["max_ms"], found["frame"]["p99_ms"]);
  EXPECT_GT(found["peak"]["copy_gb_per_s"], 0.0);
  EXPECT_GT(found["memory"]["daemon_mib"], 0.0);
  EXPECT_EQ(found["stages"].size(), 19U);
  for (const auto& stage : found["stages"]) EXPECT_GE(stage["p50_ms"], 0.0) << stage["name"];
}

TEST_F(BenchCommandTest, MeasuresOnlyTheChosenStages) {
  const Status status = run({"--frames", "2", "--stage", "solver", "map-raster", "--threads", "2",
                             "--json", file("a.json")});
  ASSERT_TRUE(status) << status.error().message;
  const auto found = json();
  EXPECT_EQ(found["threads"], 2);
  EXPECT_FALSE(found.contains("frame"));
  std::set<std::string> names;
  for (const auto& stage : found["stages"]) names.insert(stage["name"]);
  EXPECT_EQ(names, (std::set<std::string>{"solver", "map-raster"}));
}

TEST_F(BenchCommandTest, SweepsWriteOneRowPerSize) {
  const Status status = run({"--frames", "1", "--sweep", "cameras", "image", "bev", "hypotheses",
                             "--json", file("a.json")});
  ASSERT_TRUE(status) << status.error().message;
  const auto sweeps = json()["sweeps"];
  ASSERT_EQ(sweeps["cameras"].size(), 6U);
  EXPECT_EQ(sweeps["cameras"][5]["cameras"], 6.0);
  EXPECT_EQ(sweeps["image"][2]["width_px"], 1280.0);
  EXPECT_EQ(sweeps["bev"][2]["rows"], 400.0);
  EXPECT_EQ(sweeps["hypotheses"][1]["hypotheses"], 21.0 * 11.0 * 21.0);
}

TEST_F(BenchCommandTest, RefusesUnknownAndConflictingArguments) {
  EXPECT_THROW(run({"--stage", "coffee"}), CLI::ValidationError);
  EXPECT_THROW(run({"--sweep", "weather"}), CLI::ValidationError);
  EXPECT_THROW(run({"--frames", "0"}), CLI::ValidationError);
  EXPECT_THROW(run({"--threads", "0"}), CLI::ValidationError);
  EXPECT_THROW(run({"--stage", "solver", "--sweep", "map"}), CLI::ExcludesError);
}

TEST_F(BenchCommandTest, ErrorsNameTheFile) {
  const Status missing = run({}, file("none.yaml"));
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("none.yaml"));
  EXPECT_THROW(run({"--stage", "can", "--json", file("none/a.json")}), CLI::ValidationError);
}

TEST_F(BenchCommandTest, WritesOverNoFileThatItReads) {
  const std::string config = test::write_own_config(folder_.path());
  for (const char* input : {"own.yaml", "rig.yaml"}) {
    const std::string before = test::read_text(file(input));
    const Status refused = run({"--stage", "can", "--frames", "1", "--json", file(input)}, config);
    ASSERT_FALSE(refused) << input;
    EXPECT_THAT(refused.error().message, HasSubstr("found a file to write that is also read"));
    EXPECT_EQ(test::read_text(file(input)), before);
  }
}

TEST_F(BenchCommandTest, TheProgramExitsWithTwo) {
  const std::string command =
      std::string(BEVLOC_PROGRAM) + " bench --stage coffee 2> " + file("error.txt");
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2);
}

}  // namespace
}  // namespace bevloc::bench
