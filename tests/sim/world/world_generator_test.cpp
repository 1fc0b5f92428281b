#include "sim/world/world_generator.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/sim/geometry.h"

namespace bevloc::sim {
namespace {

/// Every property must hold for each of these towns, including towns of training seeds.
class Town : public testing::TestWithParam<uint64_t> {
 protected:
  const World world_ = generate_world(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Demo, Town, testing::Range<uint64_t>(0, 24));
INSTANTIATE_TEST_SUITE_P(Training, Town,
                         testing::Range<uint64_t>(kFirstTrainingSeed, kFirstTrainingSeed + 8));

bool is_finite(const Polyline& line) {
  return std::all_of(line.begin(), line.end(), [](const auto& p) { return p.allFinite(); });
}

TEST_P(Town, IsTheSameEveryTime) {
  const World again = generate_world(GetParam());
  ASSERT_EQ(again.map.elements.size(), world_.map.elements.size());
  for (size_t i = 0; i < again.map.elements.size(); ++i) {
    ASSERT_EQ(again.map.elements[i].points, world_.map.elements[i].points);
  }
  ASSERT_EQ(again.walls.size(), world_.walls.size());
  for (size_t i = 0; i < again.walls.size(); ++i) {
    ASSERT_EQ(again.walls[i].base, world_.walls[i].base);
    ASSERT_EQ(again.walls[i].seed, world_.walls[i].seed);
  }
  ASSERT_EQ(again.paint_lines.size(), world_.paint_lines.size());
  ASSERT_EQ(again.posts.size(), world_.posts.size());
  ASSERT_EQ(again.traffic.size(), world_.traffic.size());
}

TEST_P(Town, IsFinite) {
  for (const MapElement& e : world_.map.elements) EXPECT_TRUE(is_finite(e.points));
  for (const Lane& lane : world_.map.lanes) {
    EXPECT_TRUE(is_finite(lane.left) && is_finite(lane.right) && is_finite(lane.centerline));
  }
  for (const Surface& surface : world_.surfaces) EXPECT_TRUE(is_finite(surface.ring));
  for (const PaintLine& line : world_.paint_lines) EXPECT_TRUE(is_finite(line.points));
  for (const PaintArea& area : world_.paint_areas) EXPECT_TRUE(is_finite(area.ring));
  for (const Wall& wall : world_.walls) EXPECT_TRUE(is_finite(wall.base));
  for (const Post& post : world_.posts) EXPECT_TRUE(post.position.allFinite());
}

TEST_P(Town, HasAllClassesAndAReasonableSize) {
  std::set<ElementClass> classes;
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  Eigen::Vector2d high = Eigen::Vector2d::Zero();
  for (const MapElement& element : world_.map.elements) {
    classes.insert(element.element_class);
    for (const Eigen::Vector2d& point : element.points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  EXPECT_EQ(classes.size(), 3U);
  EXPECT_GT((high - low).minCoeff(), 150.0);
  EXPECT_LT((high - low).maxCoeff(), 1000.0);
}

TEST_P(Town, EveryLaneHasASuccessorThatContinuesIt) {
  ASSERT_FALSE(world_.map.lanes.empty());
  for (const Lane& lane : world_.map.lanes) {
    ASSERT_FALSE(lane.successors.empty());
    for (const uint32_t next : lane.successors) {
      ASSERT_LT(next, world_.map.lanes.size());
      const Polyline& following = world_.map.lanes[next].centerline;
      EXPECT_LT((following.front() - lane.centerline.back()).norm(), 0.05);
      const Eigen::Vector2d end =
          (lane.centerline.back() - lane.centerline[lane.centerline.size() - 2]).normalized();
      const Eigen::Vector2d start = (following[1] - following[0]).normalized();
      EXPECT_GT(end.dot(start), 0.9) << lane.centerline.back().transpose();
    }
  }
}

TEST_P(Town, LaneBoundsLieOnTheirSides) {
  for (const Lane& lane : world_.map.lanes) {
    const Eigen::Vector2d forward = (lane.centerline[1] - lane.centerline[0]).normalized();
    EXPECT_GT(cross(forward, lane.left.front() - lane.centerline.front()), 1.0);
    EXPECT_LT(cross(forward, lane.right.front() - lane.centerline.front()), -1.0);
  }
}

TEST_P(Town, NoBoundaryCrossesALane) {
  for (const MapElement& element : world_.map.elements) {
    if (element.element_class != ElementClass::kRoadBoundary) continue;
    for (const Lane& lane : world_.map.lanes) {
      Eigen::Vector2d place;
      EXPECT_FALSE(lines_cross(element.points, lane.centerline, &place))
          << "near " << place.transpose();
    }
  }
}

TEST_P(Town, NoBoundaryCrossesItself) {
  for (const MapElement& element : world_.map.elements) {
    if (element.element_class != ElementClass::kRoadBoundary) continue;
    Eigen::Vector2d place;
    EXPECT_FALSE(lines_cross(element.points, element.points, &place))
        << "near " << place.transpose();
  }
}

TEST_P(Town, CurvesAreSampledFinely) {
  for (const MapElement& element : world_.map.elements) {
    if (element.element_class == ElementClass::kPedestrianCrossing) continue;
    for (size_t i = 2; i < element.points.size(); ++i) {
      const Eigen::Vector2d before = element.points[i - 1] - element.points[i - 2];
      const Eigen::Vector2d after = element.points[i] - element.points[i - 1];
      const double turn = std::abs(std::atan2(cross(before, after), before.dot(after)));
      EXPECT_LT(turn, 0.6) << element.points[i].transpose();
    }
  }
}

TEST_P(Town, MostDividersOfTheMapArePainted) {
  size_t dividers = 0;
  size_t painted = 0;
  for (const MapElement& element : world_.map.elements) {
    if (element.element_class != ElementClass::kLaneDivider) continue;
    ++dividers;
    const Path path(element.points);
    const Eigen::Vector2d middle = path.position(0.5 * path.length_m());
    for (const PaintLine& line : world_.paint_lines) {
      if (distance_to_line(middle, line.points) > 0.4) continue;
      ++painted;
      break;
    }
  }
  ASSERT_GT(dividers, 5U);
  EXPECT_GT(static_cast<double>(painted), 0.8 * static_cast<double>(dividers));
}

TEST(WorldGenerator, MapsAndRoadsAreNotIdentical) {
  size_t ghosts = 0;
  for (uint64_t seed = 100; seed < 110; ++seed) {
    const World world = generate_world(seed);
    for (const MapElement& element : world.map.elements) {
      if (element.element_class != ElementClass::kLaneDivider) continue;
      const Path path(element.points);
      const Eigen::Vector2d middle = path.position(0.5 * path.length_m());
      const bool painted = std::any_of(
          world.paint_lines.begin(), world.paint_lines.end(),
          [&](const PaintLine& line) { return distance_to_line(middle, line.points) < 0.4; });
      if (!painted) ++ghosts;
    }
  }
  EXPECT_GT(ghosts, 0U);
}

TEST(WorldGenerator, SeedsMakeDifferentTowns) {
  std::set<double> sizes;
  for (const uint64_t base : {uint64_t{0}, kFirstTrainingSeed}) {
    for (uint64_t seed = base; seed < base + 10; ++seed) {
      sizes.insert(polyline_length(generate_world(seed).map.elements.front().points));
    }
  }
  EXPECT_GT(sizes.size(), 18U);
}

TEST(WorldGenerator, TrainingSeedsGiveOtherTowns) {
  const World demo = generate_world(7);
  const World training = generate_world(kFirstTrainingSeed + 7);
  EXPECT_NE(demo.map.elements.front().points, training.map.elements.front().points);
}

}  // namespace
}  // namespace bevloc::sim
