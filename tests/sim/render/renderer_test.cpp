#include "sim/render/renderer.h"

#include <array>
#include <cmath>
#include <memory>
#include <thread>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "pipeline/preprocessing/network_camera.h"
#include "sim/render/ground_tiles.h"
#include "sim/sim_rig.h"
#include "tests/sim/render/small_world.h"

namespace bevloc::sim {
namespace {

RgbImage draw(const World& world, const CameraModel& camera, const Se2& pose,
              const Conditions& conditions, uint64_t noise_seed = 0, const Stance& stance = {}) {
  Renderer renderer(world);
  RgbImage image;
  renderer.render(camera, pose, stance, 0.0, conditions, noise_seed, image);
  return image;
}

CameraModel front_camera() {
  return nominal_rig().cameras[1];
}

/// Mean colour of 3 x 3 pixels around a place.
Eigen::Vector3d colour_at(const RgbImage& image, const Eigen::Vector2d& pixel) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      const uint8_t* at = image.row(static_cast<int>(std::lround(pixel.y())) + dv) +
                          3 * (static_cast<int>(std::lround(pixel.x())) + du);
      sum += Eigen::Vector3d(at[0], at[1], at[2]);
    }
  }
  return sum / 9.0;
}

/// Projects a map point with the camera model of the pipeline.
Eigen::Vector2d pixel_of(const CameraModel& camera, const Se2& pose, const BodyMotion& body,
                         const Eigen::Vector3d& map_point) {
  const Eigen::Matrix3d rotation = (Eigen::AngleAxisd(pose.yaw_rad, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(body.pitch_rad, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(body.roll_rad, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
  const Se3 map_from_vehicle{rotation, {pose.x_m, pose.y_m, body.lift_m}};
  const auto pixel = camera.intrinsics.project(
      (map_from_vehicle * camera.vehicle_from_camera).inverse() * map_point);
  EXPECT_TRUE(pixel.has_value());
  return pixel.value_or(Eigen::Vector2d::Zero());
}

/// Centroid of the difference between two images.
Eigen::Vector2d centre_of_change(const RgbImage& a, const RgbImage& b) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0.0;
  for (int v = 0; v < a.height; ++v) {
    for (int u = 0; u < a.width; ++u) {
      const double change = std::abs(a.row(v)[3 * u + 1] - b.row(v)[3 * u + 1]);
      if (change < 3.0) continue;
      sum += change * Eigen::Vector2d(u, v);
      weight += change;
    }
  }
  EXPECT_GT(weight, 0.0) << "nothing differs";
  return sum / weight;
}

struct PlacedView {
  int camera;
  BodyMotion body;
  Eigen::Vector2d spot;  ///< on the ground, in the vehicle frame
  bool network_size;
  GroundShape ground{};
};

class PaintedSpot : public testing::TestWithParam<PlacedView> {};

TEST_P(PaintedSpot, AppearsWhereTheCameraModelProjectsIt) {
  const PlacedView& view = GetParam();
  const Se2 pose{31.7, -12.3, 0.9};
  Rig rig = nominal_rig();
  if (view.network_size) rig = network_rig(rig);
  const CameraModel& camera = rig.cameras[static_cast<size_t>(view.camera)];
  const World bare = asphalt_plain();
  World painted = asphalt_plain();
  const Eigen::Vector2d spot = pose * view.spot;
  painted.paint_areas.push_back({square(spot.x(), spot.y(), 0.2), {0.8F, 0.8F, 0.8F}, 0.0F});

  const Eigen::Vector2d seen =
      centre_of_change(draw(bare, camera, pose, even_light(), 0, {view.body, view.ground}),
                       draw(painted, camera, pose, even_light(), 0, {view.body, view.ground}));
  const double height_m = CurvedGround(view.ground, pose).height_m(spot);
  const Eigen::Vector2d expected =
      pixel_of(camera, pose, view.body, {spot.x(), spot.y(), height_m});
  EXPECT_NEAR(seen.x(), expected.x(), 0.5);
  EXPECT_NEAR(seen.y(), expected.y(), 0.5);
}

INSTANTIATE_TEST_SUITE_P(
    Cameras, PaintedSpot,
    testing::Values(PlacedView{1, {}, {9.0, 1.0}, false},
                    PlacedView{1, {}, {8.0, -3.5}, false},  // far off the axis, with distortion
                    PlacedView{1, {0.02, 0.01, 0.05}, {9.0, 1.0}, false},
                    PlacedView{0, {-0.015, 0.02, 0.0}, {6.0, 6.0}, false},
                    PlacedView{3, {}, {-2.0, 7.0}, false},
                    PlacedView{4, {0.01, -0.02, -0.04}, {-7.0, 3.5}, false},
                    PlacedView{1, {}, {9.0, 1.0}, true},
                    PlacedView{5, {0.01, 0.01, 0.0}, {-1.0, -6.0}, true},
                    PlacedView{1, {}, {14.0, 1.0}, false, {0.01, 0.0, 0.0}},
                    PlacedView{1, {}, {12.0, -2.0}, false, {-0.01, 0.004, 0.003}},
                    PlacedView{0, {0.01, 0.01, 0.0}, {5.0, 6.0}, false, {0.0, 0.02, -0.005}},
                    PlacedView{4, {}, {-9.0, 1.0}, true, {0.005, 0.01, 0.005}}));

TEST(Renderer, ACrestHidesWhatIsBehindIt) {
  const World bare = asphalt_plain();
  World world = asphalt_plain();
  world.posts.push_back(
      {.position = {55.0, 0.0}, .radius_m = 1.0, .top_m = 1.0, .kind = PostKind::kSign});
  const CameraModel camera = front_camera();
  const auto draw_on = [&](const World& shown, const GroundShape& ground) {
    return draw(shown, camera, {}, even_light(), 0, {.ground = ground}).pixels;
  };
  const GroundShape crest{.along_per_m = -0.005};  // 7.5 m lower at 55 m
  EXPECT_NE(draw_on(bare, {}), draw_on(world, {}));
  EXPECT_EQ(draw_on(bare, crest), draw_on(world, crest));
}

TEST(CurvedGround, GoesOnWithAConstantGradeFarAway) {
  const CurvedGround ground({.along_per_m = 0.002}, {10.0, 0.0, 0.0});
  EXPECT_DOUBLE_EQ(ground.height_m({10.0, 0.0}), 0.0);
  EXPECT_NEAR(ground.height_m({40.0, 5.0}), 0.9, 1e-9);
  const double grade = 0.002 * kCurvedReach_m;
  EXPECT_NEAR(ground.height_m({210.0, 0.0}) - ground.height_m({110.0, 0.0}), 100.0 * grade, 1e-9);
}

TEST(Renderer, PutsASignWhereTheCameraModelProjectsIt) {
  const World bare = asphalt_plain();
  World world = asphalt_plain();
  world.posts.push_back({.position = {15.0, 4.0},
                         .radius_m = 0.3,
                         .bottom_m = 2.0,
                         .top_m = 2.6,
                         .kind = PostKind::kSign});
  const CameraModel camera = front_camera();
  const Eigen::Vector2d seen =
      centre_of_change(draw(bare, camera, {}, even_light()), draw(world, camera, {}, even_light()));
  const Eigen::Vector2d expected = pixel_of(camera, {}, {}, {15.0, 4.0, 2.3});
  EXPECT_NEAR(seen.x(), expected.x(), 0.7);
  EXPECT_NEAR(seen.y(), expected.y(), 0.7);
}

TEST(Renderer, DrawsTheSameBytesAgain) {
  const World world = short_street();
  const Conditions conditions;
  const RgbImage first = draw(world, front_camera(), {}, conditions, 5);
  EXPECT_EQ(first.width, 640);
  EXPECT_EQ(first.height, 360);
  EXPECT_EQ(first.pixels, draw(world, front_camera(), {}, conditions, 5).pixels);
}

TEST(Renderer, DoesNotDependOnWhatItDrewBefore) {
  const World world = short_street();
  const Conditions conditions;
  const RgbImage fresh = draw(world, front_camera(), {}, conditions, 5);
  Renderer renderer(world);
  RgbImage image;
  // The views need so much ground that the cache drops the first tiles.
  for (int i = 0; i < 60; ++i) {
    const Se2 pose{-250.0 + 9.0 * i, 100.0 * std::sin(i), 0.7 * i};
    renderer.render(front_camera(), pose, {}, i, {}, 1, image);
  }
  renderer.render(front_camera(), {}, {}, 0.0, conditions, 5, image);
  EXPECT_EQ(image.pixels, fresh.pixels);
}

TEST(Renderer, NoiseSeedAffectsOnlyTheNoise) {
  const World world = short_street();
  Conditions conditions;
  conditions.noise_sigma = 3.0;
  const RgbImage a = draw(world, front_camera(), {}, conditions, 1);
  const RgbImage b = draw(world, front_camera(), {}, conditions, 2);
  double sum = 0.0;
  double squares = 0.0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const double difference = static_cast<double>(a.pixels[i]) - b.pixels[i];
    sum += difference;
    squares += difference * difference;
  }
  const auto count = static_cast<double>(a.pixels.size());
  EXPECT_NEAR(sum / count, 0.0, 0.1);
  // The difference of two independent noises; clipping at white reduces it slightly.
  EXPECT_NEAR(std::sqrt(squares / count), 3.0 * std::sqrt(2.0), 0.5);

  conditions.noise_sigma = 0.0;
  EXPECT_EQ(draw(world, front_camera(), {}, conditions, 1).pixels,
            draw(world, front_camera(), {}, conditions, 2).pixels);
}

/// A wall across the road ahead.
Wall wall_at(double x_m, const Rgb& albedo, double top_m) {
  return {.base = {{x_m, -10.0}, {x_m, 10.0}},
          .top_m = top_m,
          .texture = WallTexture::kKerbPlain,
          .albedo = albedo};
}

TEST(Renderer, NearObjectsHideFarOnes) {
  const Rgb red{0.7F, 0.05F, 0.05F};
  const Rgb green{0.05F, 0.7F, 0.05F};
  const CameraModel camera = front_camera();
  for (const bool near_first : {true, false}) {
    World world = asphalt_plain();
    world.walls = {wall_at(12.0, red, 1.0), wall_at(20.0, green, 4.0)};
    if (!near_first) std::swap(world.walls[0], world.walls[1]);
    const RgbImage image = draw(world, camera, {}, even_light());
    const Eigen::Vector3d low = colour_at(image, pixel_of(camera, {}, {}, {12.0, 0.5, 0.6}));
    EXPECT_GT(low.x(), 2.0 * low.y()) << "the near wall is red";
    const Eigen::Vector3d high = colour_at(image, pixel_of(camera, {}, {}, {20.0, 0.5, 3.0}));
    EXPECT_GT(high.y(), 2.0 * high.x()) << "the green wall is visible above it";
  }
}

TEST(Renderer, AVehicleHidesThePaintBehindIt) {
  World painted = asphalt_plain();
  painted.paint_areas.push_back({.ring = square(14.5, 0.0, 0.4)});
  World hidden = painted;
  hidden.parked.push_back(
      {.centre = {11.0, 0.0}, .yaw_rad = 1.5708, .albedo = {0.02F, 0.02F, 0.3F}});
  const CameraModel camera = front_camera();
  const Eigen::Vector2d spot = pixel_of(camera, {}, {}, {14.5, 0.0, 0.0});
  const double open = colour_at(draw(painted, camera, {}, even_light()), spot).x();
  const double covered = colour_at(draw(hidden, camera, {}, even_light()), spot).x();
  EXPECT_LT(covered, 0.6 * open);
}

TEST(Renderer, OmitsABodyThatOverlapsTheEgoVehicle) {
  const World bare = asphalt_plain();
  World world = asphalt_plain();
  world.parked.push_back({.centre = {1.5, 0.2}});
  EXPECT_EQ(draw(world, front_camera(), {}, even_light()).pixels,
            draw(bare, front_camera(), {}, even_light()).pixels);
}

TEST(Renderer, NightIsDarkerThanDay) {
  const World world = short_street();
  Conditions day;
  Conditions night;
  night.sun_elevation_rad = -0.5;
  EXPECT_LT(mean_of(draw(world, front_camera(), {}, night)),
            0.6 * mean_of(draw(world, front_camera(), {}, day)));
}

TEST(Renderer, HeadlightsLightTheRoadAhead) {
  const World world = asphalt_plain();
  Conditions night;
  night.sun_elevation_rad = -0.5;
  night.noise_sigma = 0.0;
  const Rig rig = nominal_rig();
  const RgbImage ahead = draw(world, rig.cameras[1], {}, night);
  const RgbImage behind = draw(world, rig.cameras[4], {}, night);
  const double road_ahead =
      colour_at(ahead, pixel_of(rig.cameras[1], {}, {}, {12.0, 0.0, 0.0})).x();
  const double road_behind =
      colour_at(behind, pixel_of(rig.cameras[4], {}, {}, {-12.0, 0.0, 0.0})).x();
  EXPECT_GT(road_ahead, 1.3 * road_behind);
}

TEST(Renderer, SunCastsShadows) {
  World world = asphalt_plain();
  world.walls.push_back({.base = {{5.0, 6.0}, {30.0, 6.0}}, .top_m = 4.0});
  Conditions conditions = even_light();
  conditions.overcast = 0.0;
  conditions.sun_elevation_rad = 0.8;
  conditions.sun_azimuth_rad = 1.57;  // behind the wall
  const CameraModel camera = front_camera();
  const RgbImage image = draw(world, camera, {}, conditions);
  const double shaded = colour_at(image, pixel_of(camera, {}, {}, {14.0, 4.0, 0.0})).y();
  const double sunny = colour_at(image, pixel_of(camera, {}, {}, {14.0, -1.0, 0.0})).y();
  EXPECT_LT(shaded, 0.75 * sunny);
}

TEST(Renderer, DrawsPosesFarOutsideTheWorld) {
  const World world = short_street();
  Renderer renderer(world);
  RgbImage image;
  for (const double far : {5e3, -2e5, 3e6}) {
    for (const CameraModel& camera : nominal_rig().cameras) {
      renderer.render(camera, {far, -0.7 * far, 1.0}, {}, 1.0, {}, 3, image);
      EXPECT_GT(mean_of(image), 20.0);
      EXPECT_LT(mean_of(image), 240.0);
    }
  }
}

TEST(Renderer, DrawsAnEmptyWorldAndOddBodies) {
  const World world;
  Renderer renderer(world);
  RgbImage image;
  for (const BodyMotion& body : {BodyMotion{0.5, 0.0, 0.0}, BodyMotion{-0.5, 0.3, 0.0},
                                 BodyMotion{0.0, 0.0, -2.0}, BodyMotion{0.0, 1.5, 3.0}}) {
    renderer.render(front_camera(), {}, {.body = body}, 0.0, {}, 3, image);
    EXPECT_GT(mean_of(image), 20.0);
  }
}

TEST(Renderer, TwoRenderersShareTheGround) {
  const World world = short_street();
  const Rig rig = nominal_rig();
  const auto ground = std::make_shared<GroundTiles>(world);
  const auto draw_half = [&](Renderer& renderer, size_t first) {
    std::vector<RgbImage> images(rig.cameras.size() / 2);
    for (int i = 0; i < 12; ++i) {  // paints many tiles and drops some
      const Se2 pose{-66.0 + 6.0 * i, 1.0, 0.1};
      for (size_t c = 0; c < images.size(); ++c) {
        renderer.render(rig.cameras[first + c], pose, {}, 0.1 * i, {}, c, images[c]);
      }
    }
    return images;
  };
  std::array<std::vector<RgbImage>, 2> together;
  std::vector<std::thread> threads;
  for (size_t half = 0; half < together.size(); ++half) {
    threads.emplace_back([&, half] {
      Renderer renderer(ground);
      together[half] = draw_half(renderer, 3 * half);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (size_t half = 0; half < together.size(); ++half) {
    Renderer alone(world);
    const std::vector<RgbImage> expected = draw_half(alone, 3 * half);
    for (size_t c = 0; c < expected.size(); ++c) {
      EXPECT_EQ(together[half][c].pixels, expected[c].pixels) << kCameraNames[3 * half + c];
    }
  }
}

TEST(Renderer, SeveralRenderersShareAWorld) {
  const World world = short_street();
  const Rig rig = nominal_rig();
  const auto draw_camera = [&](size_t i) {
    return draw(world, rig.cameras[i], {2.0, 1.0, 0.1}, {}, i);
  };
  std::vector<RgbImage> together(rig.cameras.size());
  std::vector<std::thread> threads;
  for (size_t i = 0; i < together.size(); ++i) {
    threads.emplace_back([&, i] { together[i] = draw_camera(i); });
  }
  for (std::thread& thread : threads) thread.join();
  for (size_t i = 0; i < together.size(); ++i) {
    EXPECT_EQ(together[i].pixels, draw_camera(i).pixels) << kCameraNames[i];
  }
}

}  // namespace
}  // namespace bevloc::sim
