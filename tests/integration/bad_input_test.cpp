// bevlocd ends with exit code 2 and one line on stderr when an input is wrong.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/integration/bevlocd_process.h"

namespace bevloc::test {
namespace {

void expect_refused(const std::string& arguments, const std::vector<std::string>& wanted_words) {
  const ProcessResult result = run_bevlocd(arguments);
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  for (const std::string& word : wanted_words) {
    EXPECT_NE(result.err.find(word), std::string::npos) << word << " in: " << result.err;
  }
}

class BadInputTest : public testing::Test {
 protected:
  void expect_config_refused(const std::string& piece, const std::string& replacement,
                             const std::vector<std::string>& wanted_words) {
    write_file(scratch_ / "config.yaml", demo_config_with(piece, replacement));
    for (const char* mode : {" --check-config", " --fast --duration 1"}) {
      expect_refused("--config " + (scratch_ / "config.yaml").string() + mode + " --out " +
                         (scratch_ / "out").string(),
                     wanted_words);
    }
  }

  std::string config_with_model(const std::string& model) {
    std::string text = demo_config_with("level: info", "level: info");
    const size_t at = text.find("file: ") + 6;
    text.replace(at, text.find('\n', at) - at, model);
    write_file(scratch_ / "config.yaml", text);
    return (scratch_ / "config.yaml").string();
  }

  TemporaryFolder scratch_;
};

TEST_F(BadInputTest, TheShippedConfigurationIsGood) {
  const ProcessResult result = run_bevlocd("--check-config --config " +
                                           std::string(BEVLOC_SOURCE_DIR) + "/config/demo.yaml");
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(BadInputTest, NoSuchConfiguration) {
  expect_refused("--config /nowhere/config.yaml", {"/nowhere/config.yaml"});
}

TEST_F(BadInputTest, UnknownKey) {
  expect_config_refused("rate_hz: 10", "rate_hz: 10\n  colour: red", {"config.yaml:7", "colour"});
}

TEST_F(BadInputTest, NoPhotographs) {
  expect_config_refused("  duration_s: 60\n",
                        "  duration_s: 60\n  street: {photos: /nowhere/photos}\n",
                        {"/nowhere/photos"});
}

TEST_F(BadInputTest, BrokenModel) {
  write_file(scratch_ / "broken.onnx", "not a model");
  expect_refused("--config " + config_with_model((scratch_ / "broken.onnx").string()) +
                     " --fast --duration 1 --out " + (scratch_ / "out").string(),
                 {"broken.onnx"});
}

TEST_F(BadInputTest, BrokenMap) {
  write_file(scratch_ / "broken.osm", "<osm><node id='1' lat='49' ");
  expect_refused("--config " + std::string(BEVLOC_SOURCE_DIR) + "/config/demo.yaml --fast --map " +
                     (scratch_ / "broken.osm").string() + " --out " + (scratch_ / "out").string(),
                 {"broken.osm"});
}

TEST_F(BadInputTest, OutputFolderThatCannotBeMade) {
  write_file(scratch_ / "file", "");
  expect_refused("--config " + std::string(BEVLOC_SOURCE_DIR) +
                     "/config/demo.yaml --fast --duration 1 --out " +
                     (scratch_ / "file/out").string(),
                 {"file/out"});
}

TEST_F(BadInputTest, AResultThatCannotBeWritten) {
  const std::string result = (scratch_ / "no/result.json").string();
  expect_refused("--config " + std::string(BEVLOC_SOURCE_DIR) +
                     "/config/demo.yaml --fast --duration 1 --out " + (scratch_ / "out").string() +
                     " --json " + result,
                 {result + ": found no folder"});
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "out/can.log")) << "nothing was driven";
}

TEST_F(BadInputTest, OptionsOfASimulatedDriveWithRealCameras) {
  const std::filesystem::path root = BEVLOC_SOURCE_DIR;
  const std::string config = (scratch_ / "config.yaml").string();
  write_file(config, "cameras: {driver: replay, recording: .}\ncalibration: {rig: " +
                         (root / "config/rig_demo.yaml").string() + "}\nmap: {file: " +
                         (root / "tests/pipeline/map/fixtures/street.osm").string() +
                         "}\nmodel: {file: " + (root / "models/nano.onnx").string() +
                         "}\ncan: {driver: mock}\n");
  for (const std::string& option : {std::string("--fast"), "--out " + scratch_.path().string()}) {
    expect_refused("--config " + config + " " + option,
                   {"found cameras that are not mock, wanted mock ones for", " --out,"});
  }
}

TEST_F(BadInputTest, OptionsWithoutSense) {
  const std::string demo = "--config " + std::string(BEVLOC_SOURCE_DIR) + "/config/demo.yaml ";
  for (const char* option : {"--duration nan", "--duration 1e7", "--seed -1", "--record ''",
                             "--map ''", "--save-pictures ''", "--json ''", "--json -"}) {
    const ProcessResult result = run_bevlocd(demo + "--check-config " + option);
    EXPECT_EQ(result.exit_code, 2) << option;
    EXPECT_NE(result.err.find("found"), std::string::npos) << option << ": " << result.err;
  }
}

TEST_F(BadInputTest, ARecordFolderThatIsAFile) {
  write_file(scratch_ / "file", "");
  expect_refused("--config " + std::string(BEVLOC_SOURCE_DIR) +
                     "/config/demo.yaml --check-config --record " + (scratch_ / "file").string(),
                 {"file", "wanted one for the recording"});
}

TEST_F(BadInputTest, UnknownOption) {
  const ProcessResult result = run_bevlocd("--config x --colour red");
  EXPECT_EQ(result.exit_code, 2);
}

}  // namespace
}  // namespace bevloc::test
