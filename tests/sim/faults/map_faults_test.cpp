// Faults of the map and of the world.
#include "sim/faults/map_faults.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "sim/faults/drive_clock.h"
#include "sim/faults/fault_table.h"
#include "sim/faults/world_faults.h"
#include "sim/world/road_side.h"
#include "sim/world/world_digest.h"
#include "sim/world/world_generator.h"

namespace bevloc::sim {
namespace {

class MapFaults : public testing::Test {
 protected:
  const World world_ = generate_world(2003);
  const Drive drive_{world_, 2003, 40.0};

  HdMap with(const Fault& fault) const {
    return with_faults(world_.map, std::vector{fault}, drive_);
  }
  Eigen::Vector2d place(double time_s) const {
    return drive_.at(time_s).map_from_vehicle.translation();
  }
  /// The distance of the nearest point of an element.
  static double nearest_m(const HdMap& map, const Eigen::Vector2d& place) {
    double nearest = 1e9;
    for (const MapElement& element : map.elements) {
      for (const Eigen::Vector2d& point : element.points) {
        nearest = std::min(nearest, (point - place).norm());
      }
    }
    return nearest;
  }
};

TEST_F(MapFaults, OtherFaultsLeaveTheMapAsItIs) {
  const HdMap same = with(make_fault(FaultKind::kGnssOutage));
  ASSERT_EQ(same.elements.size(), world_.map.elements.size());
  for (size_t i = 0; i < same.elements.size(); ++i) {
    EXPECT_EQ(same.elements[i].points, world_.map.elements[i].points);
  }
}

TEST_F(MapFaults, AShiftMovesEveryElement) {
  Fault shift = make_fault(FaultKind::kMapShifted);
  shift.amounts.east_m = 1.0;
  shift.amounts.north_m = -3.0;
  const HdMap shifted = with(shift);
  ASSERT_EQ(shifted.elements.size(), world_.map.elements.size());
  for (size_t i = 0; i < shifted.elements.size(); ++i) {
    const Eigen::Vector2d moved = shifted.elements[i].points[0] - world_.map.elements[i].points[0];
    EXPECT_NEAR((moved - Eigen::Vector2d(1.0, -3.0)).norm(), 0.0, 1e-9);
  }
}

TEST_F(MapFaults, ACutLeavesNothingNearTheVehicleDuringItsTime) {
  Fault cut = make_fault(FaultKind::kMapCut, 20.0, 25.0);
  cut.amounts.radius_m = 20.0;
  const HdMap map = with(cut);
  EXPECT_LT(nearest_m(world_.map, place(22.0)), 15.0);
  EXPECT_GT(nearest_m(map, place(20.0)), 19.0);
  EXPECT_GT(nearest_m(map, place(24.0)), 19.0);
  EXPECT_NEAR(nearest_m(map, place(0.0)), nearest_m(world_.map, place(0.0)), 1.0);
}

TEST_F(MapFaults, TheMapOfElsewhereDiffersAndHasRoadsAtTheStartOfTheDrive) {
  Fault elsewhere = make_fault(FaultKind::kMapOfElsewhere);
  elsewhere.amounts.seed = 2004;
  const HdMap map = with(elsewhere);
  EXPECT_EQ(map.elements.size(), generate_world(2004).map.elements.size());
  EXPECT_EQ(map.origin.latitude_deg, world_.map.origin.latitude_deg);
  EXPECT_LT(nearest_m(map, place(0.0)), 20.0);
}

/// The mean distance of boundaries from lanes.
double mean_border_m(const HdMap& map) {
  const RoadSide road(map);
  double sum_m = 0.0;
  int count = 0;
  for (const MapElement& element : map.elements) {
    if (element.element_class != ElementClass::kRoadBoundary) continue;
    if (const auto side = road.of(Path(element.points))) {
      sum_m += side->distance_m;
      ++count;
    }
  }
  EXPECT_GT(count, 20);
  return sum_m / count;
}

TEST_F(MapFaults, MappedBordersMoveAwayFromTheLanes) {
  Fault off = make_fault(FaultKind::kMapBorderOff);
  off.amounts.outwards_m = 0.4;
  EXPECT_NEAR(mean_border_m(with(off)) - mean_border_m(world_.map), 0.4, 0.1);
  off.amounts.outwards_m = -0.4;
  EXPECT_NEAR(mean_border_m(with(off)) - mean_border_m(world_.map), -0.4, 0.1);
}

TEST_F(MapFaults, GrassGrowsOnTheRoadAndTheMapDoesNotKnow) {
  const World overgrown = with_faults(world_, std::vector{make_fault(FaultKind::kWorldGrass)});
  ASSERT_GT(overgrown.surfaces.size(), world_.surfaces.size());
  for (size_t i = world_.surfaces.size(); i < overgrown.surfaces.size(); ++i) {
    EXPECT_EQ(overgrown.surfaces[i].material, GroundMaterial::kGrass);
  }
  EXPECT_EQ(overgrown.map.elements.size(), world_.map.elements.size());
  EXPECT_NE(digest_of(overgrown), digest_of(world_));
  EXPECT_EQ(digest_of(generate_world(2003)), digest_of(world_));
}

TEST_F(MapFaults, ACutThatNoPlaceOfTheDriveMeetsLeavesTheMapAlone) {
  Fault cut = make_fault(FaultKind::kMapCut, drive_.duration_s() + 1.0);
  const HdMap same = with(cut);
  ASSERT_EQ(same.elements.size(), world_.map.elements.size());
  for (size_t i = 0; i < same.elements.size(); ++i) {
    EXPECT_EQ(same.elements[i].points, world_.map.elements[i].points) << i;
  }
}

TEST(DriveClock, AFaultOfNoLengthDoesNotHappen) {
  Fault suspend = make_fault(FaultKind::kClockSuspend, 10.0, 10.0);
  suspend.amounts.gap_s = 30.0;
  Fault gap = make_fault(FaultKind::kClockGap, 20.0, 20.0);
  gap.amounts.gap_s = 5.0;
  const std::vector faults = {suspend, gap};
  EXPECT_DOUBLE_EQ(drive_time_s(11.0, faults), 11.0);
  EXPECT_FALSE(is_in_clock_gap(21.0, faults));
  EXPECT_DOUBLE_EQ(clock_gaps_end_s(21.0, faults), 0.0);
  EXPECT_DOUBLE_EQ(added_time_s(faults), 0.0);
}

TEST(DriveClock, TheLastGapThatHasBegunEndsLast) {
  Fault early = make_fault(FaultKind::kClockGap, 10.0, 10.01);
  early.amounts.gap_s = 5.0;
  Fault late = make_fault(FaultKind::kClockGap, 12.0);
  late.amounts.gap_s = 8.0;
  const std::vector faults = {late, early};
  EXPECT_DOUBLE_EQ(clock_gaps_end_s(9.99, faults), 0.0);
  EXPECT_DOUBLE_EQ(clock_gaps_end_s(11.0, faults), 15.0);
  EXPECT_DOUBLE_EQ(clock_gaps_end_s(12.0, faults), 20.0);
}

TEST(DriveClock, AFaultAfterASuspensionBeginsLaterInTheDrive) {
  Fault suspend = make_fault(FaultKind::kClockSuspend, 1.0);
  suspend.amounts.gap_s = 6.0;
  const auto stuck =
      in_drive_time({make_fault(FaultKind::kOdometryStuck, 3.0, 5.0)}, std::vector{suspend});
  EXPECT_DOUBLE_EQ(stuck[0].from_s, 9.0);
  EXPECT_DOUBLE_EQ(stuck[0].until_s, 11.0);
}

TEST(DriveClock, ASuspensionIsNotShownAndAGapIs) {
  Fault suspend = make_fault(FaultKind::kClockSuspend, 10.0);
  suspend.amounts.gap_s = 30.0;
  Fault gap = make_fault(FaultKind::kClockGap, 20.0);
  gap.amounts.gap_s = 5.0;
  const std::vector faults = {suspend, gap};
  EXPECT_DOUBLE_EQ(drive_time_s(9.0, faults), 9.0);
  EXPECT_DOUBLE_EQ(drive_time_s(10.0, faults), 40.0);
  EXPECT_DOUBLE_EQ(drive_time_s(21.0, faults), 51.0);
  EXPECT_FALSE(is_in_clock_gap(19.99, faults));
  EXPECT_TRUE(is_in_clock_gap(20.0, faults));
  EXPECT_FALSE(is_in_clock_gap(25.0, faults));
  EXPECT_DOUBLE_EQ(added_time_s(faults), 30.0);
}

}  // namespace
}  // namespace bevloc::sim
