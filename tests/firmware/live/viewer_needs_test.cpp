// Tests when trail and map are sent to the viewers of the live page.
#include "firmware/live/viewer_needs.h"

#include <gtest/gtest.h>

namespace bevloc::firmware {
namespace {

PoseSnapshot pose_at(double x_m) {
  PoseSnapshot pose;
  pose.known = true;
  pose.map_from_vehicle.x_m = x_m;
  return pose;
}

TEST(ViewerNeeds, AViewerGetsTrailAndMapOnce) {
  ViewerNeeds needs;
  needs.set();
  EXPECT_TRUE(needs.take_trail());
  EXPECT_FALSE(needs.take_trail());
  ASSERT_TRUE(needs.take_map(pose_at(5.0)));
  EXPECT_FALSE(needs.take_map(pose_at(5.0)));
  needs.set();
  EXPECT_TRUE(needs.take_trail());
  ASSERT_TRUE(needs.take_map(pose_at(7.0)));
}

TEST(ViewerNeeds, TheMapIsOwedUntilAPoseIsKnown) {
  ViewerNeeds needs;
  needs.set();
  EXPECT_FALSE(needs.take_map({}));
  const auto centre_m = needs.take_map(pose_at(5.0));
  ASSERT_TRUE(centre_m);
  EXPECT_EQ(centre_m->x(), 5.0);
}

TEST(ViewerNeeds, WhoComesWhileThePoseIsLostGetsTheLatestMap) {
  ViewerNeeds needs;
  needs.set();
  ASSERT_TRUE(needs.take_map(pose_at(5.0)));
  needs.set();
  const auto centre_m = needs.take_map({});
  ASSERT_TRUE(centre_m);
  EXPECT_EQ(centre_m->x(), 5.0);
  EXPECT_FALSE(needs.take_map(pose_at(6.0))) << "the vehicle has hardly moved";
}

TEST(ViewerNeeds, TheMapFollowsTheVehicle) {
  ViewerNeeds needs;
  ASSERT_TRUE(needs.take_map(pose_at(0.0)));
  EXPECT_FALSE(needs.take_map(pose_at(ViewerNeeds::kMapRenewal_m - 1.0)));
  const auto centre_m = needs.take_map(pose_at(ViewerNeeds::kMapRenewal_m + 1.0));
  ASSERT_TRUE(centre_m);
  EXPECT_EQ(centre_m->x(), ViewerNeeds::kMapRenewal_m + 1.0);
  needs.forget_place();
  EXPECT_TRUE(needs.take_map(pose_at(ViewerNeeds::kMapRenewal_m + 1.0))) << "another map";
}

}  // namespace
}  // namespace bevloc::firmware
