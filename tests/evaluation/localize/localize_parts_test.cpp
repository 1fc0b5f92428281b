// The parts of `bevloc localize`: the pose on the command line, the pictures, what was perceived.
#include <fstream>

#include <gmock/gmock.h>

#include "common/image_file.h"
#include "evaluation/localize/perception_score.h"
#include "evaluation/localize/picture_set.h"
#include "evaluation/localize/prior_text.h"
#include "sim/sim_rig.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

HdMap map_at(const GeoOrigin& origin) {
  HdMap map;
  map.origin = origin;
  map.elements = {{ElementClass::kLaneDivider, Appearance::kSolid, {{-100.0, 0.0}, {100.0, 0.0}}}};
  return map;
}

const HdMap kKarlsruhe = map_at({49.01, 8.41});

TEST(PriorText, MetresAndDegreesInTheMapFrame) {
  const auto given = pose_from("12.5,-3,90", PoseFrame::kGuess, kKarlsruhe);
  ASSERT_TRUE(given) << given.error().message;
  EXPECT_DOUBLE_EQ(given->pose.x_m, 12.5);
  EXPECT_DOUBLE_EQ(given->pose.y_m, -3.0);
  EXPECT_NEAR(given->pose.yaw_rad, radians(90.0), 1e-12);
  EXPECT_EQ(text_of(*given),
            "prior: x 12.500 m, y -3.000 m, yaw 90.000 degrees in the map, read as metres and "
            "degrees of its frame\n");
}

TEST(PriorText, LatitudeLongitudeAndHeadingWhereTheyLieOnTheMap) {
  for (const PoseFrame frame : {PoseFrame::kGeodetic, PoseFrame::kGuess}) {
    const auto given = pose_from("49.0101,8.4101,45", frame, kKarlsruhe);
    ASSERT_TRUE(given) << given.error().message;
    EXPECT_NEAR(given->pose.x_m, 7.3, 0.1);
    EXPECT_NEAR(given->pose.y_m, 11.1, 0.1);
    EXPECT_NEAR(degrees(given->pose.yaw_rad), 45.0, 1e-3);
    EXPECT_THAT(text_of(*given), HasSubstr("read as latitude, longitude and heading"));
  }
}

TEST(PriorText, MetresThatLookLikeAPlaceOnTheMapNeedTheOption) {
  const auto given = pose_from("49.0101,8.4101,45", PoseFrame::kMap, kKarlsruhe);
  ASSERT_TRUE(given) << given.error().message;
  EXPECT_DOUBLE_EQ(given->pose.x_m, 49.0101);
  EXPECT_THAT(text_of(*given), HasSubstr("read as metres"));
  EXPECT_TRUE(pose_from("0,0,0", PoseFrame::kGuess, map_at({0.0, 0.0})));
}

TEST(PriorText, ALatitudeAndLongitudeBesideTheMapAreNotTakenForMetres) {
  // 5.6 km south of the map, which has no place there.
  const auto beside = pose_from("48.96,8.41,90", PoseFrame::kGuess, kKarlsruhe);
  ASSERT_FALSE(beside);
  EXPECT_THAT(beside.error().message,
              AllOf(StartsWith("--prior: found '48.96,8.41,90', which is 5.6 km outside of the map "
                               "as latitude and longitude"),
                    HasSubstr("--frame map")));
  EXPECT_TRUE(pose_from("48.96,8.41,90", PoseFrame::kMap, kKarlsruhe));
  const auto far = pose_from("10,20,90", PoseFrame::kGuess, kKarlsruhe);
  ASSERT_TRUE(far) << far.error().message;
  EXPECT_EQ(far->frame, PoseFrame::kMap);
}

TEST(PriorText, SaysWhyAPlaceOnEarthCannotBeUsed) {
  const auto message = [](const char* text, const GeoOrigin& origin) {
    return pose_from(text, PoseFrame::kGeodetic, map_at(origin)).error().message;
  };
  EXPECT_EQ(message("98.41,49.01,90", kKarlsruhe.origin),
            "--prior: found 98.41 as latitude, wanted -90 to 90");
  EXPECT_EQ(message("49.01,188.41,90", kKarlsruhe.origin),
            "--prior: found 188.41 as longitude, wanted -180 to 180");
  EXPECT_THAT(message("49.01,8.41,90", {0.0, 0.0}),
              AllOf(StartsWith("--prior: found a map whose place on earth is unknown"),
                    HasSubstr("--frame map")));
}

TEST(PriorText, RefusesOtherTextAndPlacesFarAway) {
  for (const char* text : {"", "1,2", "1,2,3,4", "1;2;3", "a,b,c", "1,2,3x"}) {
    const auto given = pose_from(text, PoseFrame::kGuess, kKarlsruhe);
    ASSERT_FALSE(given) << text;
    EXPECT_THAT(given.error().message,
                AllOf(StartsWith("--prior: "), HasSubstr("wanted three numbers")));
  }
  for (const char* text : {"1e300,0,0", "0,-1e8,0", "0,0,99999"}) {
    EXPECT_EQ(pose_from(text, PoseFrame::kMap, kKarlsruhe).error().message,
              fmt::format("--prior: found '{}', wanted at most 10000000 m and 360 degrees", text));
  }
  const auto far = pose_from("5000,0,0", PoseFrame::kGuess, kKarlsruhe);
  ASSERT_FALSE(far);
  EXPECT_THAT(far.error().message, HasSubstr("x 5000 m"));
  EXPECT_THAT(far.error().message, HasSubstr("x -100 m"));
  const auto nowhere = pose_from("5000,0,0", PoseFrame::kGuess, map_at({0.0, 0.0}));
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().message, Not(HasSubstr("around")));
}

class PictureSetTest : public testing::Test {
 protected:
  void add_picture(const std::string& name, int width_px = 640) {
    ASSERT_TRUE(write_png(RgbImage(width_px, 360).view(), folder_ / name));
  }

  const test::TemporaryFolder folder_;
  const Rig rig_ = sim::nominal_rig();
};

TEST_F(PictureSetTest, ReadsTheCamerasThatHaveAFile) {
  const Intrinsics& front = rig_.cameras[1].intrinsics;
  ASSERT_TRUE(write_png(RgbImage(front.width_px, front.height_px).view(), folder_ / "front.png"));
  const auto set = read_pictures(folder_.path(), rig_);
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(set->present.count(), 1U);
  EXPECT_TRUE(set->present[1]);
  EXPECT_EQ(set->images().images[1].width, front.width_px);
}

TEST_F(PictureSetTest, RefusesAFolderWithoutPicturesOtherSizesAndTwoPicturesOfACamera) {
  const auto message = [this] { return read_pictures(folder_.path(), rig_).error().message; };
  EXPECT_THAT(message(), HasSubstr("wanted files such as front_left.jpg"));
  EXPECT_THAT(read_pictures(folder_ / "gone", rig_).error().message,
              HasSubstr("gone: found no folder that can be read"));
  add_picture("back.png", 64);
  EXPECT_THAT(message(), AllOf(HasSubstr("back.png"), HasSubstr("image_size_px in the rig")));
  add_picture("back.jpg");
  EXPECT_THAT(message(), HasSubstr("found back.jpg and back.png"));
}

TEST_F(PictureSetTest, TakesExtensionsInCapitalsAndNamesPicturesOfNoCamera) {
  const Intrinsics& front = rig_.cameras[1].intrinsics;
  for (const char* name : {"front.PNG", "frontleft.png"}) {
    ASSERT_TRUE(write_png(RgbImage(front.width_px, front.height_px).view(), folder_ / name));
  }
  std::ofstream(folder_ / "rig.yaml") << "front: 1\n";
  const auto set = read_pictures(folder_.path(), rig_);
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_TRUE(set->present[1]);
  EXPECT_THAT(set->strays, testing::ElementsAre(folder_ / "frontleft.png"));
}

TEST_F(PictureSetTest, ReadsMotionsByCamera) {
  const std::filesystem::path file = folder_ / "motion.yaml";
  std::ofstream(file) << "front: {x_m: -0.3, y_m: 0.01, yaw_deg: 2}\n";
  const auto motions = read_motions(file);
  ASSERT_TRUE(motions) << motions.error().message;
  EXPECT_DOUBLE_EQ((*motions)[1].x_m, -0.3);
  EXPECT_NEAR((*motions)[1].yaw_rad, radians(2.0), 1e-12);
  EXPECT_EQ((*motions)[0].x_m, 0.0);
  std::ofstream(file) << "fornt: {x_m: -0.3, y_m: 0.01, yaw_deg: 2}\n";
  EXPECT_THAT(read_motions(file).error().message, HasSubstr("fornt"));
  std::ofstream(file) << "front: {x_m: 300, y_m: 0.01, yaw_deg: 2}\n";
  EXPECT_THAT(read_motions(file).error().message, HasSubstr("wanted a number, -10 to 10"));
}

TEST(PerceptionScoreTest, CountsWhatLiesWithinTheDistance) {
  const auto plane = static_cast<size_t>(kRasterGrid.cells());
  std::vector<float> logits(kRasterChannels * plane, -5.0F);
  std::vector<uint8_t> raster(kRasterChannels * plane, 0);
  const auto set_row = [&](auto& values, int row, int count, auto value) {
    std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(row) * kRasterGrid.cols, count, value);
  };
  // A mapped row; its first half is perceived 2 cells (0.30 m) away, the rest 5 cells away.
  set_row(raster, 100, 100, uint8_t{255});
  set_row(logits, 102, 50, 5.0F);
  for (int col = 50; col < 100; ++col) {
    logits[static_cast<size_t>(105 * kRasterGrid.cols + col)] = 5.0F;
  }
  const PerceptionScore scores = score_perception(logits, raster);
  EXPECT_EQ(scores[0].mapped, 100);
  EXPECT_EQ(scores[0].perceived, 100);
  EXPECT_NEAR(scores[0].recall, 0.5, 0.04);
  EXPECT_NEAR(scores[0].precision, 0.5, 0.04);
  EXPECT_EQ(scores[1].mapped, 0);
  EXPECT_EQ(scores[1].recall, 0.0);
}

}  // namespace
}  // namespace bevloc::evaluation
