#include "pipeline/network/view/view_table.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "pipeline/preprocessing/network_camera.h"
#include "tests/pipeline/preprocessing/surround_rig.h"
#include "tests/support/cell_places.h"

namespace bevloc {
namespace {

constexpr CameraMask kAllCameras{0b111111};
constexpr int kCells = kFeatureGrid.cells();

class ViewTableTest : public ::testing::Test {
 protected:
  float weight_sum(const ViewTable& table, int cell) const {
    float sum = 0.0F;
    for (int slot = 0; slot < kViewSlots; ++slot) sum += table.weight[slot * kCells + cell];
    return sum;
  }

  std::set<int> cameras_of(const ViewTable& table, int cell) const {
    std::set<int> cameras;
    for (int slot = 0; slot < kViewSlots; ++slot) {
      const size_t entry = slot * kCells + cell;
      if (table.weight[entry] > 0.0F) cameras.insert(table.index[entry] / kImageFeatureCells);
    }
    return cameras;
  }

  const Rig rig_ = network_rig(test::surround_rig());
  const ViewTable table_ = make_view_table(rig_, kAllCameras, kFeatureGrid);
};

TEST_F(ViewTableTest, WeightsOfACellSumToOneOrAreAllZero) {
  ASSERT_EQ(table_.index.size(), static_cast<size_t>(kViewSlots * kCells));
  ASSERT_EQ(table_.weight.size(), static_cast<size_t>(kViewSlots * kCells));
  for (const float weight : table_.weight) EXPECT_GE(weight, 0.0F);
  for (const int32_t index : table_.index) {
    EXPECT_GE(index, 0);
    EXPECT_LT(index, kCameraCount * kImageFeatureCells);
  }
  for (int cell = 0; cell < kCells; ++cell) {
    const float sum = weight_sum(table_, cell);
    EXPECT_NEAR(sum, sum == 0.0F ? 0.0F : 1.0F, 1e-5F) << "cell " << cell;
  }
}

TEST_F(ViewTableTest, EntriesLieWhereTheNetworkCameraSeesTheCell) {
  int checked = 0;
  for (int cell = 0; cell < kCells; ++cell) {
    const Eigen::Vector2d place = test::place_of(kFeatureGrid, cell);
    const Eigen::Vector3d centre(place.x(), place.y(), 0.0);
    for (const int camera : cameras_of(table_, cell)) {
      double share = 0.0;
      Eigen::Vector2d feature = Eigen::Vector2d::Zero();
      for (int slot = 0; slot < kViewSlots; ++slot) {
        const size_t entry = slot * kCells + cell;
        if (table_.index[entry] / kImageFeatureCells != camera) continue;
        const int in_camera = table_.index[entry] % kImageFeatureCells;
        share += table_.weight[entry];
        feature += table_.weight[entry] *
                   Eigen::Vector2d(in_camera % kImageFeatureCols, in_camera / kImageFeatureCols);
      }
      const CameraModel& model = rig_.cameras[camera];
      const auto pixel = model.intrinsics.project(model.vehicle_from_camera.inverse() * centre);
      ASSERT_TRUE(pixel.has_value());
      // Feature (r, c) covers 8 x 8 pixels; its centre is pixel (8c + 3.5, 8r + 3.5).
      Eigen::Vector2d expected = (*pixel - Eigen::Vector2d(3.5, 3.5)) / kImageFeatureStride;
      expected.x() = std::clamp(expected.x(), 0.0, kImageFeatureCols - 1.0);
      expected.y() = std::clamp(expected.y(), 0.0, kImageFeatureRows - 1.0);
      if (share < 1e-3) continue;
      EXPECT_LT((feature / share - expected).norm(), 1e-3) << "cell " << cell;
      ++checked;
    }
  }
  EXPECT_GT(checked, kCells);
}

TEST_F(ViewTableTest, SixCamerasSeeNearlyEverythingButARingAroundTheCar) {
  int far_cells = 0;
  int far_seen = 0;
  for (int cell = 0; cell < kCells; ++cell) {
    const double distance_m = test::place_of(kFeatureGrid, cell).norm();
    const bool seen = weight_sum(table_, cell) > 0.0F;
    EXPECT_FALSE(seen && distance_m < 1.0) << "a camera sees the ground under the car";
    if (distance_m < 8.0 || distance_m > 25.0) continue;
    ++far_cells;
    far_seen += seen;
  }
  EXPECT_GT(far_seen, 0.98 * far_cells);
}

TEST_F(ViewTableTest, WithoutACameraOnlyItsOwnCellsGoDark) {
  constexpr int kLost = 1;
  CameraMask available = kAllCameras;
  available.reset(kLost);
  const ViewTable without = make_view_table(rig_, available, kFeatureGrid);
  int dark = 0;
  int taken_over = 0;
  for (int cell = 0; cell < kCells; ++cell) {
    const std::set<int> before = cameras_of(table_, cell);
    const float sum = weight_sum(without, cell);
    EXPECT_FALSE(cameras_of(without, cell).contains(kLost));
    if (before == std::set<int>{kLost}) {
      EXPECT_EQ(sum, 0.0F);
      ++dark;
    } else if (!before.empty()) {
      EXPECT_NEAR(sum, 1.0F, 1e-5F);
      taken_over += before.contains(kLost);
    }
  }
  EXPECT_GT(dark, 100);
  EXPECT_GT(taken_over, 20);
}

TEST_F(ViewTableTest, WithoutCamerasAllIsDark) {
  const ViewTable dark = make_view_table(rig_, CameraMask{}, kFeatureGrid);
  for (const float weight : dark.weight) EXPECT_EQ(weight, 0.0F);
  for (const int32_t index : dark.index) EXPECT_EQ(index, 0);
}

/// The share of one camera in a cell at (x, y), computed with a grid of this one cell.
double share_at(Rig rig, int camera, double x_m, double y_m) {
  for (CameraModel& model : rig.cameras) {
    model.vehicle_from_camera.translation_m -= Eigen::Vector3d(x_m, y_m, 0.0);
  }
  const BevGrid here{1, 1, 0.1};
  const ViewTable table = make_view_table(rig, kAllCameras, here);
  double share = 0.0;
  for (int slot = 0; slot < kViewSlots; ++slot) {
    if (table.index[slot] / kImageFeatureCells == camera) share += table.weight[slot];
  }
  return share;
}

TEST_F(ViewTableTest, SharesAreContinuousAcrossTheOverlapOfTwoCameras) {
  constexpr int kFrontLeft = 0;
  constexpr int kFront = 1;
  constexpr double kStepM = 0.005;
  double previous = share_at(rig_, kFront, 15.0, 0.0);
  ASSERT_NEAR(previous, 1.0, 1e-6);
  for (double y_m = kStepM; y_m < 14.0; y_m += kStepM) {
    const double share = share_at(rig_, kFront, 15.0, y_m);
    EXPECT_LE(std::abs(share - previous), 0.02) << "at y = " << y_m;
    previous = share;
  }
  EXPECT_EQ(previous, 0.0);
  EXPECT_NEAR(share_at(rig_, kFrontLeft, 15.0, 14.0), 1.0, 1e-6);
}

TEST_F(ViewTableTest, SecondPlaceChangesHandsWithoutAJump) {
  Rig rig = rig_;  // with three cameras that all see x = 15 m, at slightly different yaw
  rig.cameras[0] = network_camera(test::camera_at(1.5, 0.0, 1.5, 0.2, radians(65.0)));
  rig.cameras[1] = network_camera(test::camera_at(1.5, 0.0, 1.5, 0.0, radians(65.0)));
  rig.cameras[2] = network_camera(test::camera_at(1.5, 0.0, 1.5, -0.2, radians(65.0)));
  constexpr double kStepM = 0.005;
  for (const int camera : {0, 1, 2}) {
    double previous = share_at(rig, camera, 15.0, -3.0);
    for (double y_m = -3.0 + kStepM; y_m < 3.0; y_m += kStepM) {
      const double share = share_at(rig, camera, 15.0, y_m);
      EXPECT_LE(std::abs(share - previous), 0.02) << "camera " << camera << " at y = " << y_m;
      previous = share;
    }
  }
}

TEST_F(ViewTableTest, UpdatingInPlaceEqualsMaking) {
  ViewTable table = table_;
  const int32_t* const index = table.index.data();
  CameraMask available = kAllCameras;
  available.reset(4);
  CameraMotions motions{};
  motions[1] = {1.5, 0.1, 0.02};
  update_view_table(rig_, available, kFeatureGrid, motions, table);
  const ViewTable made = make_view_table(rig_, available, kFeatureGrid, motions);
  EXPECT_EQ(table.index.data(), index);
  EXPECT_EQ(table.index, made.index);
  EXPECT_EQ(table.weight, made.weight);
}

TEST_F(ViewTableTest, AVehicleThatDroveOnByACellSeesEachCellAsTheOneBefore) {
  CameraMotions motions;
  motions.fill({kFeatureGrid.cell_m, 0.0, 0.0});
  const ViewTable moved = make_view_table(rig_, kAllCameras, kFeatureGrid, motions);
  for (int slot = 0; slot < kViewSlots; ++slot) {
    for (int cell = 0; cell < kCells - kFeatureGrid.cols; ++cell) {
      const size_t here = slot * kCells + cell;
      const size_t nearer = here + kFeatureGrid.cols;
      ASSERT_NEAR(moved.weight[here], table_.weight[nearer], 1e-4F) << "cell " << cell;
      if (moved.weight[here] > 1e-4F) {
        ASSERT_EQ(moved.index[here], table_.index[nearer]);
      }
    }
  }
}

TEST_F(ViewTableTest, AMovedCameraSeesAsOneThatIsMountedThere) {
  const Se2 motion{1.2, -0.1, 0.03};
  CameraMotions motions{};
  motions[2] = motion;
  Rig rig = rig_;
  Se3 reference_from_exposure;
  reference_from_exposure.rotation.topLeftCorner<2, 2>() << std::cos(motion.yaw_rad),
      -std::sin(motion.yaw_rad), std::sin(motion.yaw_rad), std::cos(motion.yaw_rad);
  reference_from_exposure.translation_m = {motion.x_m, motion.y_m, 0.0};
  Se3& mounting = rig.cameras[2].vehicle_from_camera;
  mounting = reference_from_exposure * mounting;

  const ViewTable moved = make_view_table(rig_, kAllCameras, kFeatureGrid, motions);
  const ViewTable mounted = make_view_table(rig, kAllCameras, kFeatureGrid);
  EXPECT_NE(moved.weight, table_.weight);
  for (size_t entry = 0; entry < moved.weight.size(); ++entry) {
    ASSERT_NEAR(moved.weight[entry], mounted.weight[entry], 1e-4F);
    if (moved.weight[entry] > 1e-4F) {
      ASSERT_EQ(moved.index[entry], mounted.index[entry]);
    }
  }
}

TEST_F(ViewTableTest, TheMotionOfACameraThatIsNotThereDoesNotCount) {
  CameraMask available = kAllCameras;
  available.reset(3);
  CameraMotions motions{};
  motions[3] = {1.0, 0.0, 0.0};
  const ViewTable moved = make_view_table(rig_, available, kFeatureGrid, motions);
  EXPECT_EQ(moved.weight, make_view_table(rig_, available, kFeatureGrid).weight);
}

}  // namespace
}  // namespace bevloc
