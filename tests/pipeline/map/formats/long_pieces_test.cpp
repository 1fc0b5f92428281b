// Long pieces of a reference line.
#include <gtest/gtest.h>

#include "pipeline/map/formats/opendrive/road.h"

namespace bevloc::opendrive {
namespace {

TEST(OpendriveGeometry, KnotsDoNotMoveALongPiece) {
  Geometry spiral;
  spiral.kind = Geometry::Kind::kSpiral;
  spiral.length_m = 5000.0;
  spiral.end_curvature = 0.005;
  Geometry poly = spiral;
  poly.kind = Geometry::Kind::kPoly3;
  poly.v = {0.0, 0.0, 0.1, 2e-5, -1e-8};
  for (const Geometry& plain : {spiral, poly}) {
    Geometry with_knots = plain;
    place_knots(with_knots);
    EXPECT_GT(with_knots.knots.size(), 40U);
    for (double along_m = 0.0; along_m <= 5000.0; along_m += 49.9) {
      const LinePose wanted = pose_along(plain, along_m);
      const LinePose found = pose_along(with_knots, along_m);
      EXPECT_LT((found.position - wanted.position).norm(), 1e-5) << along_m;
      EXPECT_NEAR(found.heading_rad, wanted.heading_rad, 1e-8) << along_m;
    }
  }
}

}  // namespace
}  // namespace bevloc::opendrive
