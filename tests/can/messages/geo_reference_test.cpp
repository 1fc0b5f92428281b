#include "can/messages/geo_reference.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/pose_matchers.h"

namespace bevloc::can {
namespace {

constexpr GeodeticPosition kKarlsruhe{49.0069, 8.4037};

TEST(GeoReference, TheOriginIsTheOriginAndEastIs90Degrees) {
  GeoReference geo(kKarlsruhe);
  const GeodeticPose pose = geo.geodetic_from_map({0.0, 0.0, 0.0});
  EXPECT_NEAR(pose.position.latitude_deg, kKarlsruhe.latitude_deg, 1e-12);
  EXPECT_NEAR(pose.position.longitude_deg, kKarlsruhe.longitude_deg, 1e-12);
  EXPECT_NEAR(pose.heading_deg, 90.0, 1e-9);
}

TEST(GeoReference, HeadingsRunClockwiseFromNorth) {
  GeoReference geo(kKarlsruhe);
  const auto heading = [&](double yaw_rad) {
    return geo.geodetic_from_map({0, 0, yaw_rad}).heading_deg;
  };
  EXPECT_NEAR(std::remainder(heading(0.5 * std::numbers::pi), 360.0), 0.0, 1e-9);
  EXPECT_NEAR(heading(std::numbers::pi), 270.0, 1e-9);
  EXPECT_NEAR(heading(-0.5 * std::numbers::pi), 180.0, 1e-9);
  for (double yaw_rad = -7.0; yaw_rad < 7.0; yaw_rad += 0.01) {
    EXPECT_GE(heading(yaw_rad), 0.0);
    EXPECT_LT(heading(yaw_rad), 360.0);
  }
}

TEST(GeoReference, OneHundredMetresNorthAreTheKnownAngle) {
  GeoReference geo(kKarlsruhe);
  // Closed form of the meridian's radius of curvature at this latitude (WGS84).
  const double e2 = 6.69437999014e-3;
  const double s = std::sin(radians(kKarlsruhe.latitude_deg));
  const double meridian_m = 6378137.0 * (1.0 - e2) / std::pow(1.0 - e2 * s * s, 1.5);
  const GeodeticPose pose = geo.geodetic_from_map({0.0, 100.0, 0.0});
  EXPECT_NEAR(radians(pose.position.latitude_deg - kKarlsruhe.latitude_deg) * meridian_m, 100.0,
              1e-3);
}

TEST(GeoReference, HeadingsAccountForMeridianConvergence) {
  GeoReference geo(kKarlsruhe);
  const GeodeticPose pose = geo.geodetic_from_map({10000.0, 0.0, 0.5 * std::numbers::pi});
  const double expected_deg = (pose.position.longitude_deg - kKarlsruhe.longitude_deg) *
                              std::sin(radians(kKarlsruhe.latitude_deg));
  EXPECT_GT(expected_deg, 0.1);
  EXPECT_NEAR(pose.heading_deg, expected_deg, 1e-3)
      << "the meridians converge, so true north is to the left of map north";
}

/// The conversion that docs/can.md and the comment of Heading give to consumers.
TEST(GeoReference, TheHeadingInTheMapFollowsFromLongitudeAndLatitude) {
  for (const GeodeticPosition origin :
       {kKarlsruhe, GeodeticPosition{65.0, 25.0}, GeodeticPosition{-33.9, 151.2}}) {
    GeoReference geo(origin);
    for (const double x_m : {-50000.0, 50000.0}) {
      for (const double y_m : {-50000.0, 0.0, 50000.0}) {
        for (const double yaw_rad : {-2.0, 0.0, 0.5, 2.5}) {
          const GeodeticPose pose = geo.geodetic_from_map({x_m, y_m, yaw_rad});
          const double turned_deg = (pose.position.longitude_deg - origin.longitude_deg) *
                                    std::sin(radians(pose.position.latitude_deg));
          EXPECT_GT(std::abs(turned_deg), 0.25);
          const double from_map_north_deg = 90.0 - degrees(yaw_rad);
          EXPECT_NEAR(std::remainder(pose.heading_deg - turned_deg - from_map_north_deg, 360.0),
                      0.0, 5e-3);
        }
      }
    }
  }
}

TEST(GeoReference, RoundTripsAcrossAWholeCity) {
  for (const GeodeticPosition origin :
       {kKarlsruhe, GeodeticPosition{0.0, 0.0}, GeodeticPosition{-33.9, 151.2},
        GeodeticPosition{68.4, 17.4}, GeodeticPosition{52.0, 180.0}}) {
    GeoReference geo(origin);
    for (const double x_m : {-40000.0, -300.0, 0.0, 12.34, 40000.0}) {
      for (const double y_m : {-40000.0, -1.5, 0.0, 40000.0}) {
        const Se2 pose{x_m, y_m, wrap_angle(1e-3 * x_m + y_m)};
        const Se2 back = geo.map_from_geodetic(geo.geodetic_from_map(pose));
        EXPECT_THAT(back, test::PoseNear(pose, 1e-4, 1e-9));
      }
    }
  }
}

TEST(GeoReference, NotFiniteStaysNotFinite) {
  GeoReference geo(kKarlsruhe);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const GeodeticPose pose = geo.geodetic_from_map({nan, nan, nan});
  EXPECT_FALSE(std::isfinite(pose.position.latitude_deg));
  EXPECT_FALSE(std::isfinite(pose.heading_deg));
  EXPECT_FALSE(geo.map_from_geodetic({{nan, nan}, nan}).is_finite());
  GeoReference nowhere({nan, nan});
  EXPECT_FALSE(std::isfinite(nowhere.geodetic_from_map({}).position.latitude_deg));
}

}  // namespace
}  // namespace bevloc::can
