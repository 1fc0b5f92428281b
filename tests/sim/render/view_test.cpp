#include "sim/render/view.h"

#include <gtest/gtest.h>

#include "sim/sim_rig.h"

namespace bevloc::sim {
namespace {

TEST(CameraRays, MatchTheCameraModel) {
  constexpr double kTolerance_px = 0.01;
  for (const CameraModel& camera : nominal_rig().cameras) {
    const Intrinsics& intrinsics = camera.intrinsics;
    const CameraRays rays(intrinsics);
    std::vector<float> x(static_cast<size_t>(intrinsics.width_px));
    std::vector<float> y(x.size());
    for (int v = 0; v < intrinsics.height_px; v += 7) {
      rays.get(static_cast<size_t>(v) * x.size(), intrinsics.width_px, x.data(), y.data());
      for (int u = 0; u < intrinsics.width_px; ++u) {
        const auto i = static_cast<size_t>(u);
        const Eigen::Vector3d expected = intrinsics.ray({u, v});
        EXPECT_NEAR(x[i], expected.x(), kTolerance_px / intrinsics.fx_px);
        EXPECT_NEAR(y[i], expected.y(), kTolerance_px / intrinsics.fy_px);
        EXPECT_TRUE(x[i] >= rays.low().x() && x[i] <= rays.high().x()) << u << ", " << v;
        EXPECT_TRUE(y[i] >= rays.low().y() && y[i] <= rays.high().y()) << u << ", " << v;
      }
    }
  }
}

TEST(CameraRays, ACameraOfOnePixelLooksAhead) {
  Intrinsics intrinsics;
  intrinsics.width_px = intrinsics.height_px = 1;
  intrinsics.fx_px = intrinsics.fy_px = 1.0;
  const CameraRays rays(intrinsics);
  float x = 1.0F;
  float y = 1.0F;
  rays.get(0, 1, &x, &y);
  EXPECT_EQ(x, 0.0F);
  EXPECT_EQ(y, 0.0F);
}

}  // namespace
}  // namespace bevloc::sim
