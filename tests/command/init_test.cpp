// Tests `bevloc init` with offered devices and a typed dialog.
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "command/init/init_command.h"
#include "common/files.h"
#include "evaluation/drive/drive_config.h"
#include "tests/support/command_line.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/text.h"

namespace bevloc::command {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::filesystem::path kTree = BEVLOC_SOURCE_DIR;

class InitTest : public testing::Test {
 protected:
  /// Runs `bevloc init` with these arguments; `typed` null: nobody is there to answer.
  Result<Verdict> init(std::vector<std::string> arguments, const char* typed = nullptr) {
    CLI::App app;
    InitCommand command(&reader_);
    command.declare(app);
    arguments.insert(arguments.begin(), {"init", "--out", file_.string()});
    test::parse(app, std::move(arguments));
    std::istringstream in(typed == nullptr ? "" : typed);
    Dialog dialog(in, said_, typed != nullptr);
    return command.run(offers_, dialog);
  }
  std::string written() const { return test::read_text(file_); }
  std::vector<std::string> real_cameras() const {
    return {"--cameras",
            "v4l2",
            "--id",
            "a",
            "b",
            "c",
            "d",
            "e",
            "f",
            "--rig",
            (kTree / "config/rig_demo.yaml").string(),
            "--map",
            (kTree / "tests/pipeline/map/fixtures/street.osm").string(),
            "--model",
            (kTree / "models/nano.onnx").string()};
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "new.yaml";
  Offers offers_;
  std::ostringstream said_;
  std::optional<evaluation::SimulationConfig> simulation_;
  firmware::SimulationReader reader_ = evaluation::simulation_reader(simulation_);
};

TEST_F(InitTest, WithoutAnyDeviceWritesASimulationThatIsGood) {
  std::filesystem::current_path(kTree);  // where the rig and the model of the demo lie
  const auto verdict = init({"--yes"});
  ASSERT_TRUE(verdict) << verdict.error().message;
  EXPECT_EQ(*verdict, Verdict::kGood);
  const auto config = evaluation::load_drive_config(file_);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_TRUE(config->simulation);
  EXPECT_EQ(config->can.driver, firmware::CanDriver::kMock);
}

TEST_F(InitTest, ReplacesAFileOnlyWithForce) {
  std::ofstream(file_) << "mine";
  const auto refused = init({"--yes"});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("--force"));
  EXPECT_EQ(written(), "mine");
  std::filesystem::current_path(kTree);
  ASSERT_TRUE(init({"--yes", "--force"}));
  EXPECT_NE(written(), "mine");
  EXPECT_EQ(*read_file(file_.string() + ".bak"), "mine");
}

TEST_F(InitTest, KeepsTheOldFileWhereItCannotWrite) {
  std::ofstream(file_) << "mine";
  std::filesystem::create_directory(file_.string() + ".new");  // where the draft would be
  std::filesystem::current_path(kTree);
  ASSERT_FALSE(init({"--yes", "--force"}));
  EXPECT_EQ(written(), "mine");
}

/// The daemon runs as another user than the one who writes the configuration.
TEST_F(InitTest, WritesANewFileThatAllMayRead) {
  std::filesystem::current_path(kTree);
  const auto init_with_umask_077 = [this](std::vector<std::string> arguments) {
    const mode_t before = umask(077);
    const auto verdict = init(std::move(arguments));
    umask(before);
    return verdict;
  };
  ASSERT_TRUE(init_with_umask_077({"--yes"}));
  EXPECT_EQ(std::filesystem::status(file_).permissions(), std::filesystem::perms{0644});
  std::filesystem::permissions(file_, std::filesystem::perms{0640});
  ASSERT_TRUE(init_with_umask_077({"--yes", "--force"}));
  EXPECT_EQ(std::filesystem::status(file_).permissions(), std::filesystem::perms{0640});
}

TEST_F(InitTest, WritesRealCamerasAndSaysThatTheyAreNotThere) {
  auto arguments = real_cameras();
  arguments.insert(arguments.end(), {"--can", "can9"});
  const auto verdict = init(arguments);
  ASSERT_TRUE(verdict) << verdict.error().message;
  EXPECT_EQ(*verdict, Verdict::kBad);
  const auto config = firmware::load_config(file_);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->cameras.devices.ids[5], "f");
  EXPECT_EQ(config->can.interface, "can9");
}

TEST_F(InitTest, RefusesAMockBusBesideRealCameras) {
  auto arguments = real_cameras();
  arguments.insert(arguments.end(), {"--can", "mock"});
  const auto refused = init(arguments);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("--can: found mock beside real cameras"));
  EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST_F(InitTest, AsksUntilAnAnswerIsGood) {
  for (const char* id : {"one", "two", "three", "four", "five", "six"}) {
    offers_.v4l2.push_back({id, "Camera"});
  }
  offers_.can_interfaces = {"can0"};
  const std::string rig = (kTree / "config/rig_demo.yaml").string();
  const std::string map = (kTree / "tests/pipeline/map/fixtures/street.osm").string();
  const std::string model = (kTree / "models/nano.onnx").string();
  // The driver is proposed. The second camera is first given the id of the first one.
  const std::string typed =
      "\n2\n2\n1\n\n\n\n\n" + rig + "\nno_file\n" + map + "\n" + model + "\n\n";
  const auto verdict = init({}, typed.c_str());
  ASSERT_TRUE(verdict) << verdict.error().message << said_.str();
  EXPECT_THAT(said_.str(), HasSubstr("a second time"));
  EXPECT_THAT(said_.str(), HasSubstr("found no file \"no_file\""));
  const auto config = firmware::load_config(file_);
  ASSERT_TRUE(config) << config.error().message << written();
  EXPECT_EQ(config->cameras.devices.ids[0], "two");
  EXPECT_EQ(config->cameras.devices.ids[1], "one");
  EXPECT_EQ(config->cameras.devices.ids[5], "six");
  EXPECT_EQ(config->can.interface, "can0");
}

TEST_F(InitTest, ShowsTheListWhoseNumbersItAsksFor) {
  for (const char* id : {"one", "two", "three", "four", "five", "six"}) {
    offers_.v4l2.push_back({id, "Camera of " + std::string(id)});
    offers_.libcamera.push_back({"/base/" + std::string(id), "libcamera"});
  }
  EXPECT_FALSE(init({"--cameras", "v4l2"}, ""));
  EXPECT_THAT(said_.str(), HasSubstr("\n  2: two (Camera of two)\n"));
  EXPECT_THAT(said_.str(), Not(HasSubstr("/base/")));
  EXPECT_LT(said_.str().find("6: six"), said_.str().find("front_left"));
  said_.str("");
  EXPECT_FALSE(init({"--cameras", "libcamera"}, ""));
  EXPECT_THAT(said_.str(), HasSubstr("\n  1: /base/one (libcamera)\n"));
  said_.str("");
  EXPECT_FALSE(init({"--cameras", "v4l2", "--id", "a", "b", "c", "d", "e", "f"}, ""));
  EXPECT_THAT(said_.str(), Not(HasSubstr("1: one")));
}

TEST_F(InitTest, RefusesIdsOfMockCameras) {
  const auto refused = init({"--cameras", "mock", "--yes", "--id", "a", "b", "c", "d", "e", "f"});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("--id: found ids beside mock cameras"));
  EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST_F(InitTest, EndsWhenTheInputEnds) {
  const auto ended = init({}, "mock\n");
  ASSERT_FALSE(ended);
  EXPECT_THAT(ended.error().message, HasSubstr("found the end of the input"));
}

TEST(ConfigurationText, KeepsStrangeNames) {
  Answers answers{.driver = kV4l2Cameras,
                  .ids = {"a: b", "\"c\"", "d\\e", "# f", "- g", "h"},
                  .rig = "/x/rig.yaml",
                  .map = "/folder/below/town.osm",
                  .model = "/x/model.onnx",
                  .can = "can0"};
  auto yaml = YamlMap::parse(configuration_text(answers, "/folder"), "t.yaml");
  ASSERT_TRUE(yaml) << yaml.error().message;
  const firmware::Config config =
      firmware::read_config(*yaml, {.folder = "/folder", .dbc_file = {}}, nullptr);
  ASSERT_TRUE(yaml->finish()) << yaml->finish().error().message;
  EXPECT_EQ(config.cameras.devices.ids, answers.ids);
  EXPECT_EQ(config.map_file, "/folder/below/town.osm");
  EXPECT_THAT(configuration_text(answers, "/folder"), HasSubstr("file: \"below/town.osm\""));
  EXPECT_EQ(config.rig_file, "/x/rig.yaml");
}

Answers plain_answers() {
  return {.driver = kV4l2Cameras,
          .ids = {"a", "b", "c", "d", "e", "f"},
          .rig = "rig.yaml",
          .map = "town.osm",
          .model = "model.onnx",
          .can = "can0"};
}

TEST(ConfigurationText, SaysWhichIdsBelongToAPlug) {
  const std::string text = configuration_text(plain_answers(), ".");
  EXPECT_THAT(text, HasSubstr("An id with a serial number stays with its camera"));
  EXPECT_THAT(text, HasSubstr("belongs to the plug"));
}

/// A list of formats in this comment would lack those that come later.
TEST(ConfigurationText, NamesThePageOfTheMapFormats) {
  const std::string text = configuration_text(plain_answers(), ".");
  EXPECT_THAT(text, HasSubstr("The HD map, in any format of docs/maps.md."));
}

}  // namespace
}  // namespace bevloc::command
