// Which rigs are refused, because the network would see little of the road, and which get a
// warning.
#include "pipeline/preprocessing/view_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/calibration/rig_yaml.h"
#include "sim/sim_rig.h"
#include "tests/support/turned_rig.h"

namespace bevloc {
namespace {

using test::turned_down;
using testing::HasSubstr;
using testing::Not;

/// A level camera in the middle of a straight lens, with a view to the sides of 90 degrees.
CameraModel camera_with_image(int width_px, int height_px) {
  CameraModel camera;
  camera.intrinsics = {.width_px = width_px,
                       .height_px = height_px,
                       .fx_px = 0.5 * width_px,
                       .fy_px = 0.5 * width_px,
                       .cx_px = 0.5 * (width_px - 1),
                       .cy_px = 0.5 * (height_px - 1)};
  camera.vehicle_from_camera.rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return camera;
}

TEST(ViewCheck, TheShippedRigsShowEverything) {
  for (const char* name : {"demo", "fisheye", "nuscenes", "van"}) {
    const std::string file = fmt::format(BEVLOC_SOURCE_DIR "/config/rig_{}.yaml", name);
    const auto rig = read_rig(file);
    ASSERT_TRUE(rig) << rig.error().message;
    for (const CameraModel& camera : rig->cameras) EXPECT_EQ(shown_share(camera), 1.0) << name;
    EXPECT_EQ(check_views(*rig, file).value(), "");
  }
}

TEST(ViewCheck, CountsTheRowsBelowTheHorizonThatTheImageHas) {
  // 82 rows of the network image are below the horizon. At its 90 degrees, each is four rows of an
  // image of 1280 columns.
  EXPECT_EQ(shown_share(camera_with_image(1280, 720)), 1.0);
  EXPECT_NEAR(shown_share(camera_with_image(1280, 400)), 50.0 / 82.0, 0.02);
  EXPECT_NEAR(shown_share(camera_with_image(1280, 160)), 20.0 / 82.0, 0.02);
}

TEST(ViewCheck, TheOwnVehicleShowsNoRoad) {
  CameraModel camera = camera_with_image(1280, 720);
  camera.own_body_px = {{639.5, -1.0}, {1281.0, -1.0}, {1281.0, 721.0}, {639.5, 721.0}};
  EXPECT_NEAR(shown_share(camera), 0.5, 0.01);
}

TEST(ViewCheck, RefusesCamerasThatShowLessThanAQuarter) {
  for (const double down_deg : {-25.0, 40.0, 55.0}) {
    const auto checked = check_views(turned_down(sim::nominal_rig(), down_deg), "rig.yaml");
    ASSERT_FALSE(checked) << down_deg;
    EXPECT_THAT(checked.error().message,
                HasSubstr("below the horizon (front_left 0 %, front 0 %, front_right 0 %,"));
  }
  Rig rig = sim::nominal_rig();
  rig.cameras[1] = turned_down(rig, 40.0).cameras[1];
  rig.cameras[4] = turned_down(rig, 40.0).cameras[4];
  EXPECT_EQ(check_views(rig, "rig.yaml").error().message,
            "rig.yaml: found cameras that show only a part of the network image below the horizon "
            "(front 0 %), wanted at least 25 %; correct rotation_wxyz, the intrinsics or "
            "own_body_px, or aim the cameras nearer to the horizon");
}

TEST(ViewCheck, WarnsOfCamerasThatShowLessThan90Percent) {
  EXPECT_EQ(check_views(turned_down(sim::nominal_rig(), 20.0), "rig.yaml").value(), "");
  const auto checked = check_views(turned_down(sim::nominal_rig(), 30.0), "rig.yaml");
  ASSERT_TRUE(checked) << checked.error().message;
  EXPECT_THAT(*checked, HasSubstr("rig.yaml: found cameras that show only a part of the network "
                                  "image below the horizon (front_left 35 %, front 40 %,"));
  EXPECT_THAT(*checked, HasSubstr("wanted at least 90 %, or the pose is less accurate"));
  EXPECT_THAT(*checked, Not(HasSubstr("back 1"))) << "the lens of the back camera is wider";
}

}  // namespace
}  // namespace bevloc
