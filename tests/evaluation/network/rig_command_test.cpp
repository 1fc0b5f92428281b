// `bevloc eval rig`: both rigs see the same places.
#include "evaluation/network/rig_command.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "common/files.h"
#include "pipeline/calibration/rig_yaml.h"
#include "sim/samples/random_rig.h"
#include "sim/sim_rig.h"
#include "tests/support/command_line.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/turned_rig.h"

namespace bevloc::evaluation {
namespace {

class RigCommandTest : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_ / name; }

  Status run(std::vector<std::string> rig) const {
    std::vector<std::string> arguments{
        "rig",    "--model",          BEVLOC_SOURCE_DIR "/models/nano.onnx", "--frames", "8",
        "--json", file("answer.json")};
    std::ranges::move(rig, std::back_inserter(arguments));
    return test::run_command<RigCommand>(arguments);
  }

  nlohmann::json answer() const {
    return nlohmann::json::parse(std::ifstream(file("answer.json")));
  }

  const test::TemporaryFolder folder_;
};

TEST_F(RigCommandTest, TheSimulatorsOwnRigCostsNothing) {
  ASSERT_TRUE(write_file(file("rig.yaml"), format_rig(sim::nominal_rig())));
  const Status status = run({file("rig.yaml")});
  ASSERT_TRUE(status) << status.error().message;
  // The file keeps nine decimals, so a few pixels are rounded the other way.
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(answer()["own"]["mae"][axis], answer()["given"]["mae"][axis], 0.05);
  }
}

TEST_F(RigCommandTest, AnotherRigAndItsOwnBodyChangeTheErrors) {
  Rig rig = sim::nominal_rig();
  for (CameraModel& camera : rig.cameras)
    camera.own_body_px = {{0, 0}, {639, 0}, {639, 359}, {0, 359}};
  ASSERT_TRUE(write_file(file("rig.yaml"), format_rig(rig)));
  const Status status = run({file("rig.yaml")});
  ASSERT_TRUE(status) << status.error().message;
  // A rig that sees only its own vehicle keeps the error of the prior.
  EXPECT_GT(answer()["given"]["mae"][1], 3.0 * answer()["own"]["mae"][1].get<double>());
}

TEST_F(RigCommandTest, TellsWhatBevlocdSaysAboutTheRig) {
  const auto said = [this](double down_deg) {
    EXPECT_TRUE(
        write_file(file("rig.yaml"), format_rig(test::turned_down(sim::nominal_rig(), down_deg))));
    testing::internal::CaptureStderr();
    const Status status = run({file("rig.yaml")});
    EXPECT_TRUE(status) << status.error().message;
    return testing::internal::GetCapturedStderr();
  };
  const std::string found = file("rig.yaml") + ": found cameras that show only a part";
  EXPECT_THAT(said(40.0), testing::HasSubstr("bevlocd refuses " + found));
  // Almost all cameras see only the ground that the network does not look at.
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_GT(answer()["given"]["mae"][axis], 1.5 * answer()["own"]["mae"][axis].get<double>());
  }
  EXPECT_THAT(said(30.0), testing::StartsWith(found));
}

TEST_F(RigCommandTest, WritesTheRigThatItDraws) {
  const Status status = run({"--random", "7", "--write", file("drawn.yaml")});
  ASSERT_TRUE(status) << status.error().message;
  const auto drawn = read_rig(file("drawn.yaml"));
  ASSERT_TRUE(drawn) << drawn.error().message;
  EXPECT_EQ(format_rig(*drawn), format_rig(sim::random_rig(1.0, 7)));
  EXPECT_EQ(answer()["rig"], "random rig 7");
}

TEST_F(RigCommandTest, WantsAFileOrASeed) {
  EXPECT_THAT(run({}).error().message, testing::HasSubstr("wanted a file or --random SEED"));
}

TEST_F(RigCommandTest, RefusesAFileThatIsNoRig) {
  EXPECT_THAT(run({"/nonexistent.yaml"}).error().message, testing::HasSubstr("/nonexistent.yaml"));
}

}  // namespace
}  // namespace bevloc::evaluation
