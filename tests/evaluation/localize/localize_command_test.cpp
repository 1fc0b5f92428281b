// `bevloc localize` on pictures of a simulated town.
#include "evaluation/localize/localize_command.h"

#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "common/files.h"
#include "common/image_file.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/map/map_binary.h"
#include "sim/render/renderer.h"
#include "sim/sim_rig.h"
#include "sim/vehicle/placement.h"
#include "sim/world/world_generator.h"
#include "tests/support/command_line.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/turned_rig.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;

constexpr uint64_t kTown = 11;

/// A folder with what a user has: rig, map, and six pictures from `pose()`.
class LocalizeCommandTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    const sim::World world = sim::generate_world(kTown);
    sim::Random random(3);
    pose_ = sim::random_pose_on_road(world, random);
    const Rig rig = sim::nominal_rig();
    ASSERT_TRUE(write_file(file("rig.yaml"), format_rig(rig)));
    ASSERT_TRUE(write_file(file("town.bvm"), encode_map(world.map)));
    sim::Renderer renderer(world);
    RgbImage image;
    for (size_t i = 0; i < kCameraCount; ++i) {
      renderer.render(rig.cameras[i], pose_, {}, 0.0, {}, i, image);
      ASSERT_TRUE(write_png(image.view(), file(std::string(kCameraNames[i]) + ".png")));
    }
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static std::string file(const std::string& name) { return *folder_ / name; }

  static std::string text_of(const Se2& pose) {
    return fmt::format("{},{},{}", pose.x_m, pose.y_m, degrees(pose.yaw_rad));
  }

  static Status run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"localize", "--rig", file("rig.yaml"), "--map",
                                         file("town.bvm"), "--images", folder_->path(), "--frame",
                                         "map", "--model", BEVLOC_SOURCE_DIR "/models/nano.onnx"});
    return test::run_command<LocalizeCommand>(arguments);
  }

  static nlohmann::json answer() {
    return nlohmann::json::parse(std::ifstream(file("answer.json")));
  }

  static inline std::unique_ptr<test::TemporaryFolder> folder_;
  static inline Se2 pose_;
};

TEST_F(LocalizeCommandTest, FindsThePoseFromAPriorBesideIt) {
  const Se2 prior = pose_ * Se2{0.9, -0.5, radians(1.0)};
  const Status status =
      run({"--prior", text_of(prior), "--json", file("answer.json"), "--sheet", file("a.png")});
  ASSERT_TRUE(status) << status.error().message;
  const nlohmann::json json = answer();
  EXPECT_TRUE(json["evidence"]);
  EXPECT_EQ(json["cameras"].size(), 6U);
  EXPECT_NEAR(json["pose"][0], pose_.x_m, 0.6);
  EXPECT_NEAR(json["pose"][1], pose_.y_m, 0.6);
  EXPECT_NEAR(json["pose"][2], degrees(pose_.yaw_rad), 0.6);
  EXPECT_GT(json["perception"]["boundaries"]["recall"], 0.4);
  EXPECT_TRUE(std::filesystem::file_size(file("a.png")) > 100'000);
  EXPECT_TRUE(json["trusted"]);
  EXPECT_FALSE(json["at_border"][1]);
}

TEST_F(LocalizeCommandTest, SaysThatThePriorIsTooFarAway) {
  // The search reaches 1 m across.
  const Se2 prior = pose_ * Se2{0.0, 1.4, 0.0};
  testing::internal::CaptureStdout();
  const Status status = run({"--prior", text_of(prior), "--json", file("answer.json")});
  const std::string said = testing::internal::GetCapturedStdout();
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_THAT(said, HasSubstr("in the map, read as metres"));
  EXPECT_THAT(said, HasSubstr("across: the best place is at the border of the search"));
  EXPECT_TRUE(answer()["at_border"][1]);
  EXPECT_FALSE(answer()["trusted"]);
}

TEST_F(LocalizeCommandTest, ScoresManyPriorsAroundAKnownPose) {
  const Status status = run({"--prior", text_of(pose_), "--truth", "--priors", "20", "--seed", "5",
                             "--json", file("answer.json")});
  ASSERT_TRUE(status) << status.error().message;
  const nlohmann::json scores = answer()["priors"];
  EXPECT_EQ(scores["priors"], 20);
  EXPECT_EQ(scores["without_evidence"], 0);
  EXPECT_EQ(scores["without_sigma"].size(), 3U);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT(scores["bevloc"]["mae"][axis], 0.7 * scores["prior"]["mae"][axis].get<double>());
  }
}

TEST_F(LocalizeCommandTest, SaysWhichCameraIsNotUsed) {
  const std::string picture = file("back.png");
  std::filesystem::rename(picture, file("kept"));
  const Intrinsics back = sim::nominal_rig().cameras[4].intrinsics;
  ASSERT_TRUE(write_png(RgbImage(back.width_px, back.height_px).view(), picture));
  testing::internal::CaptureStderr();
  const Status status = run({"--prior", text_of(pose_), "--json", file("answer.json")});
  const std::string said = testing::internal::GetCapturedStderr();
  std::filesystem::rename(file("kept"), picture);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_THAT(said, HasSubstr("back: this camera is not used, because its picture is dark"));
  EXPECT_EQ(answer()["cameras_left_out"],
            nlohmann::json::parse(R"({"back": "its picture is dark"})"));
}

TEST_F(LocalizeCommandTest, RefusesCamerasThatShowNoRoad) {
  const Rig rig = test::turned_down(sim::nominal_rig(), 40.0);
  ASSERT_TRUE(write_file(file("rig.yaml"), format_rig(rig)));
  const Status refused = run({"--prior", text_of(pose_)});
  ASSERT_TRUE(write_file(file("rig.yaml"), format_rig(sim::nominal_rig())));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message,
              testing::StartsWith(file("rig.yaml") + ": found cameras that show only a part"));
}

TEST_F(LocalizeCommandTest, WritesOverNoFileThatItReads) {
  for (const char* input : {"rig.yaml", "town.bvm", "front.png"}) {
    const std::string before = read_file(file(input)).value();
    for (const char* option : {"--json", "--sheet"}) {
      const Status refused = run({"--prior", text_of(pose_), option, file(input)});
      ASSERT_FALSE(refused) << input;
      EXPECT_THAT(refused.error().message, HasSubstr("found a file to write that is also read"));
    }
    EXPECT_EQ(read_file(file(input)).value(), before);
  }
}

TEST_F(LocalizeCommandTest, SaysWhatIsWrong) {
  EXPECT_THAT(run({"--prior", "1,2"}).error().message, HasSubstr("wanted three numbers"));
  EXPECT_THAT(run({"--prior", text_of(pose_), "--motion", file("none.yaml")}).error().message,
              HasSubstr("none.yaml"));
  EXPECT_THROW(run({"--prior", text_of(pose_), "--priors", "3"}), CLI::RequiresError);
  EXPECT_THROW(run({"--prior", text_of(pose_), "--seed", "3"}), CLI::RequiresError);
}

}  // namespace
}  // namespace bevloc::evaluation
