// Ties of pictures of a flat ground whose grey levels follow from a formula.
#include "pipeline/calibration/refine/tie_finder.h"

#include <array>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "common/median.h"
#include "tests/pipeline/calibration/refine/road_picture.h"
#include "tests/support/demo_rig.h"

namespace bevloc {
namespace {

constexpr int kForwards = 1;

/// A number from 0 to 1 that is always the same for a corner of the grid.
double random_at(int64_t i, int64_t j) {
  uint64_t bits = static_cast<uint64_t>(i) * 0x9e3779b97f4a7c15U + static_cast<uint64_t>(j);
  for (int k = 0; k < 2; ++k) bits = (bits ^ (bits >> 31U)) * 0xbf58476d1ce4e5b9U;
  return static_cast<double>(bits >> 11U) * 0x1p-53;
}

/// Grey levels at the corners of a grid, with straight lines between them.
double grey_of_gravel(double x_m, double y_m) {
  constexpr double kCell_m = 0.15;
  const double x = x_m / kCell_m;
  const double y = y_m / kCell_m;
  const auto i = static_cast<int64_t>(std::floor(x));
  const auto j = static_cast<int64_t>(std::floor(y));
  const double a = x - static_cast<double>(i);
  const double b = y - static_cast<double>(j);
  return 60.0 + 120.0 * ((1.0 - a) * ((1.0 - b) * random_at(i, j) + b * random_at(i, j + 1)) +
                         a * ((1.0 - b) * random_at(i + 1, j) + b * random_at(i + 1, j + 1)));
}

double grey_of_asphalt(double, double) {
  return 90.0;
}

/// Stripes along the vehicle's path.
double grey_of_stripes(double, double y_m) {
  return 100.0 + 60.0 * std::sin(3.0 * y_m) * std::sin(1.1 * y_m);
}

/// A repeating pattern like tiles of 0.4 m.
double grey_of_tiles(double x_m, double y_m) {
  return 100.0 + 40.0 * std::sin(15.7 * x_m) + 40.0 * std::sin(15.7 * y_m);
}

ReferenceTrajectory straight_drive() {
  std::vector<ReferenceTrajectory::Pose> poses;
  for (int i = 0; i < 300; ++i) {
    poses.push_back({Time{} + from_seconds(0.01 * i), {0.08 * i, 0.0, 0.0}});
  }
  return ReferenceTrajectory(std::move(poses));
}

/// The front camera takes two pictures at places 1.6 m apart. A test may turn the true camera.
class TieFinderTest : public ::testing::Test {
 protected:
  static constexpr std::array kTimes_s{1.0, 1.2};

  MomentView view(size_t i, const CameraAdjustment& change = CameraAdjustment::Zero()) const {
    return *MomentView::make(rig_.cameras[kForwards], change, FrameVector::Zero(), reference_,
                             Time{} + from_seconds(kTimes_s[i]));
  }

  template <typename Grey>
  GreyImage picture(size_t i, const Grey& grey_of) const {
    const CameraModel& model = rig_.cameras[kForwards];
    const Se2 pose = *reference_.at(Time{} + from_seconds(kTimes_s[i]));
    const Se3 map_from_vehicle{Eigen::Matrix3d::Identity(), {pose.x_m, pose.y_m, 0.0}};
    const CameraModel truth = adjusted(model, truth_);
    return RoadPainter(model.intrinsics)
        .picture(map_from_vehicle * truth.vehicle_from_camera, grey_of);
  }

  template <typename Grey>
  std::vector<GroundTie> ties_of(const Grey& grey_of) const {
    return find_ties(picture(0, grey_of), view(0), picture(1, grey_of), view(1), search_);
  }

  Rig rig_ = test::demo_rig();
  ReferenceTrajectory reference_ = straight_drive();
  CameraAdjustment truth_ = CameraAdjustment::Zero();
  TieSearch search_{.spacing_px = 16.0};
};

TEST_F(TieFinderTest, FindsTheSamePlacesToAFractionOfAPixel) {
  truth_[kPitch] = radians(0.4);
  truth_[kYaw] = radians(-0.3);
  const auto ties = ties_of(grey_of_gravel);
  EXPECT_GT(ties.size(), 20U);
  const MomentView first = view(0, truth_);
  const MomentView second = view(1, truth_);
  std::vector<double> errors_px;
  for (const GroundTie& tie : ties) {
    const auto there = second.project(*first.ground_at(tie.first_px));
    errors_px.push_back((*there - tie.second_px).norm());
    EXPECT_LT(errors_px.back(), 1.0) << tie.first_px.transpose();
  }
  EXPECT_LT(median(errors_px), 0.3);
}

TEST_F(TieFinderTest, NeedsTexture) {
  EXPECT_TRUE(ties_of(grey_of_asphalt).empty());
}

TEST_F(TieFinderTest, NeedsTextureAlongBothAxes) {
  EXPECT_TRUE(ties_of(grey_of_stripes).empty());
}

TEST_F(TieFinderTest, RefusesTextureThatRepeatsWithinTheReach) {
  search_.reach_px = 40.0;
  EXPECT_TRUE(ties_of(grey_of_tiles).empty());
}

TEST_F(TieFinderTest, FindsNothingOfAnotherPlace) {
  const GreyImage first = picture(0, grey_of_gravel);
  const GreyImage elsewhere =
      picture(1, [](double x_m, double y_m) { return grey_of_gravel(x_m + 90.0, y_m - 40.0); });
  EXPECT_TRUE(find_ties(first, view(0), elsewhere, view(1), search_).empty());
}

TEST_F(TieFinderTest, LooksNeitherAtTheOwnBodyNorFarAway) {
  const size_t all = ties_of(grey_of_gravel).size();
  search_.farthest_m = 5.0;
  const size_t near = ties_of(grey_of_gravel).size();
  EXPECT_LT(near, all);
  rig_.cameras[kForwards].own_body_px = {{0.0, 0.0}, {640.0, 0.0}, {640.0, 360.0}, {0.0, 360.0}};
  EXPECT_TRUE(ties_of(grey_of_gravel).empty());
}

}  // namespace
}  // namespace bevloc
