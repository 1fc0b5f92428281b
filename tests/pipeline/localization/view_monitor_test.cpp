#include "pipeline/localization/view_monitor.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/preprocessing/image_remap.h"

namespace bevloc {
namespace {

constexpr int kTile = 16;  ///< pixels

/// A rectangle of tiles.
struct Tiles {
  int row;
  int col;
  int rows;
  int cols;
};

/// The network input of six cameras that pass a textured scene.
class ViewMonitorTest : public testing::Test {
 protected:
  static constexpr int kScene_px = 2048;

  /// A scene with details of some pixels, different for each camera, as network input.
  static const std::vector<int8_t>& scene(int camera) {
    static const auto scenes = [] {
      std::array<std::vector<int8_t>, kCameraCount> drawn;
      for (int number = 0; number < kCameraCount; ++number) {
        for (int v = 0; v < kNetworkHeightPx; ++v) {
          for (int u = 0; u < kScene_px; ++u) {
            const double x = 0.31 * u + 1.7 * number;
            const double y = 0.27 * v;
            drawn[number].push_back(static_cast<int8_t>(40.0 * std::sin(x) * std::cos(y) +
                                                        25.0 * std::sin(0.83 * x + 1.1 * y) +
                                                        15.0 * std::cos(2.3 * x)));
          }
        }
      }
      return drawn;
    }();
    return scenes[camera];
  }

  void draw(int camera, int moved_px) {
    const auto first = scene(camera).begin() + moved_px % (kScene_px - kNetworkWidthPx);
    for (int row = 0; row < 3 * kNetworkHeightPx; ++row) {
      std::copy_n(first + row % kNetworkHeightPx * kScene_px, kNetworkWidthPx,
                  planes_[camera].begin() + row * kNetworkWidthPx);
    }
  }

  void set(int camera, int u, int v, int value) {
    for (int colour = 0; colour < 3; ++colour) {
      planes_[camera][(colour * kNetworkHeightPx + v) * kNetworkWidthPx + u] =
          static_cast<int8_t>(std::clamp(value, 0, 255) - 128);
    }
  }

  void fill(int camera, const Tiles& tiles, int value) {
    for (int v = tiles.row * kTile; v < (tiles.row + tiles.rows) * kTile; ++v) {
      for (int u = tiles.col * kTile; u < (tiles.col + tiles.cols) * kTile; ++u) {
        set(camera, u, v, value);
      }
    }
  }

  /// Adds one image per camera.
  void show(bool driving) {
    for (int camera = 0; camera < kCameraCount; ++camera) {
      monitor_.add(camera, planes_[camera], driving);
    }
    monitor_.judge();
  }

  /// One frameset of a vehicle that moves; the lens of camera 2 is covered by `dirt`.
  void drive_with(const std::vector<Tiles>& dirt, bool driving = true) {
    moved_px_ += 3;
    for (int camera = 0; camera < kCameraCount; ++camera) draw(camera, moved_px_);
    // The brightness of dirt changes with the scene.
    for (const Tiles& tiles : dirt) fill(kDirty, tiles, 90 + moved_px_ % 40);
    show(driving);
  }

  void expect_only(int camera, ViewFault fault) {
    for (int i = 0; i < kCameraCount; ++i) {
      EXPECT_EQ(monitor_.fault(i), i == camera ? fault : ViewFault::kNone) << "camera " << i;
    }
    EXPECT_EQ(monitor_.with(fault), CameraMask(1U << camera));
  }

  static constexpr int kDirty = 2;
  std::array<std::vector<int8_t>, kCameraCount> planes_ = [] {
    std::array<std::vector<int8_t>, kCameraCount> planes;
    planes.fill(std::vector<int8_t>(kNetworkImageSize));
    return planes;
  }();
  int moved_px_ = 0;
  ViewMonitor monitor_;
};

constexpr Tiles kWhole{0, 0, 6, 20};

TEST_F(ViewMonitorTest, GoodViewsStayGood) {
  for (int i = 0; i < 3 * ViewMonitor::kImages; ++i) {
    drive_with({}, i > 50);
    ASSERT_TRUE(monitor_.with(ViewFault::kNone).all()) << i;
  }
}

TEST_F(ViewMonitorTest, ADarkImageIsUnusableAtOnceAndUntilTenAreGood) {
  drive_with({});
  drive_with({{kWhole}});
  fill(kDirty, kWhole, 3);
  show(true);
  expect_only(kDirty, ViewFault::kDark);
  for (int i = 1; i < ViewMonitor::kRecovery; ++i) {
    drive_with({});
    expect_only(kDirty, ViewFault::kDark);
  }
  drive_with({});
  EXPECT_TRUE(monitor_.with(ViewFault::kNone).all());
}

TEST_F(ViewMonitorTest, SixDarkCamerasAreAllDark) {
  for (int camera = 0; camera < kCameraCount; ++camera) fill(camera, kWhole, 1 + camera);
  show(false);
  EXPECT_TRUE(monitor_.with(ViewFault::kDark).all());
}

TEST_F(ViewMonitorTest, ANightWithALitRoadIsNotDark) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    fill(camera, kWhole, 2);
    fill(camera, {3, 6, 2, 4}, 45);
  }
  show(true);
  EXPECT_TRUE(monitor_.with(ViewFault::kNone).all());
}

TEST_F(ViewMonitorTest, AWhiteImageIsBlindedAndABrightSkyIsNot) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    draw(camera, 0);
    fill(camera, {0, 0, 1, 20}, 255);
  }
  fill(4, {0, 0, 3, 20}, 250);
  show(false);
  expect_only(4, ViewFault::kBlinded);
}

TEST_F(ViewMonitorTest, DirtDoesNotMoveWhileDriving) {
  const std::vector<Tiles> dirt{{2, 3, 2, 2}, {1, 11, 2, 2}};
  for (int i = 0; i < ViewMonitor::kImages; ++i) {
    drive_with(dirt);
    ASSERT_TRUE(monitor_.with(ViewFault::kNone).all()) << i;
  }
  drive_with(dirt);
  expect_only(kDirty, ViewFault::kDirty);
  for (int i = 0; i < ViewMonitor::kImages; ++i) drive_with({});
  EXPECT_TRUE(monitor_.with(ViewFault::kNone).all()) << "the lens was cleaned";
}

/// A scene that hardly moves, such as fog or a wall, says nothing about the lens.
TEST_F(ViewMonitorTest, ADirtyCameraStaysDirtyWhileTheSceneHardlyMoves) {
  const std::vector<Tiles> dirt{{2, 3, 2, 2}, {1, 11, 2, 2}};
  for (int i = 0; i < 2 * ViewMonitor::kImages; ++i) drive_with(dirt);
  expect_only(kDirty, ViewFault::kDirty);
  for (int i = 0; i < 6 * ViewMonitor::kImages; ++i) {
    for (int camera = 0; camera < kCameraCount; ++camera) fill(camera, kWhole, 100 + i % 3);
    show(true);
    ASSERT_EQ(monitor_.fault(kDirty), ViewFault::kDirty) << i;
  }
  for (int i = 0; i < 4 * ViewMonitor::kImages; ++i) drive_with({});
  EXPECT_TRUE(monitor_.with(ViewFault::kNone).all()) << "the lens was cleaned";
}

TEST_F(ViewMonitorTest, LittleDirtIsTolerated) {
  for (int i = 0; i < 2 * ViewMonitor::kImages; ++i) drive_with({{2, 3, 2, 2}});
  EXPECT_TRUE(monitor_.with(ViewFault::kNone).all());
}

TEST_F(ViewMonitorTest, AStandingVehicleSaysNothingAboutDirt) {
  for (int i = 0; i < 3 * ViewMonitor::kImages; ++i) drive_with({{1, 2, 3, 9}}, false);
  EXPECT_TRUE(monitor_.with(ViewFault::kNone).all());
}

TEST_F(ViewMonitorTest, TheOwnVehicleAtTheLowerEdgeIsNoDirt) {
  for (int i = 0; i < 2 * ViewMonitor::kImages; ++i) drive_with({{4, 2, 2, 16}});
  EXPECT_TRUE(monitor_.with(ViewFault::kNone).all());
}

TEST_F(ViewMonitorTest, WhatTheCameraCannotShowIsNoDirt) {
  const Tiles flank{0, 17, 6, 3};
  std::vector<uint8_t> shown(static_cast<size_t>(kNetworkHeightPx) * kNetworkWidthPx, 1);
  for (int v = 0; v < kNetworkHeightPx; ++v) {
    for (int u = flank.col * kTile; u < kNetworkWidthPx; ++u) shown[v * kNetworkWidthPx + u] = 0;
  }
  monitor_.set_shown(kDirty, shown);
  const auto drive = [&](const std::vector<Tiles>& dirt) {
    for (int i = 0; i <= 3 * ViewMonitor::kImages; ++i) {
      moved_px_ += 3;
      for (int camera = 0; camera < kCameraCount; ++camera) draw(camera, moved_px_);
      for (const Tiles& tiles : dirt) fill(kDirty, tiles, 90);
      fill(kDirty, flank, 0);
      show(true);
    }
  };
  drive({});
  EXPECT_TRUE(monitor_.with(ViewFault::kNone).all());
  drive({{2, 3, 2, 2}, {1, 11, 2, 2}});
  expect_only(kDirty, ViewFault::kDirty);
}

/// Its image is always the same, so that it would soon count as frozen if it did not count as dark.
TEST_F(ViewMonitorTest, ACameraThatCanShowNothingIsDark) {
  monitor_.set_shown(kDirty, std::vector<uint8_t>(kNetworkPixels, 0));
  for (int i = 0; i < 2 * ViewMonitor::kImages; ++i) {
    moved_px_ += 3;
    for (int camera = 0; camera < kCameraCount; ++camera) draw(camera, moved_px_);
    fill(kDirty, kWhole, 0);
    show(true);
    expect_only(kDirty, ViewFault::kDark);
  }
}

TEST_F(ViewMonitorTest, AWhiteImageAboveTheOwnVehicleIsBlinded) {
  std::vector<uint8_t> shown(static_cast<size_t>(kNetworkHeightPx) * kNetworkWidthPx, 1);
  std::fill_n(shown.begin() + 3 * kTile * kNetworkWidthPx, 3 * kTile * kNetworkWidthPx, 0);
  monitor_.set_shown(4, shown);
  for (int camera = 0; camera < kCameraCount; ++camera) draw(camera, 0);
  fill(4, {0, 0, 3, 20}, 250);
  show(false);
  expect_only(4, ViewFault::kBlinded);
}

TEST_F(ViewMonitorTest, AWallThatAllCamerasSeeIsNoDirt) {
  for (int i = 0; i < 2 * ViewMonitor::kImages; ++i) {
    for (int camera = 0; camera < kCameraCount; ++camera) fill(camera, kWhole, 100 + i % 3);
    show(true);
  }
  EXPECT_TRUE(monitor_.with(ViewFault::kNone).all());
}

}  // namespace
}  // namespace bevloc
