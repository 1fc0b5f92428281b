// A small world with objects at known places, for the tests of the renderer.
#pragma once

#include "sim/render/renderer.h"
#include "sim/world/world.h"

namespace bevloc::sim {

inline Ring square(double x_m, double y_m, double half_m) {
  return {{x_m - half_m, y_m - half_m},
          {x_m + half_m, y_m - half_m},
          {x_m + half_m, y_m + half_m},
          {x_m - half_m, y_m + half_m}};
}

/// A wide empty plain of asphalt.
inline World asphalt_plain() {
  World world;
  world.seed = 7;
  world.background = GroundMaterial::kGrass;
  world.surfaces.push_back({GroundMaterial::kAsphalt, 1.0F, square(0.0, 0.0, 300.0)});
  return world;
}

/// A straight street along x: dashes, a crossing, kerbs, parked cars, a house, a tree.
inline World short_street() {
  World world = asphalt_plain();
  world.paint_lines.push_back(
      {.points = {{-80.0, 0.0}, {80.0, 0.0}}, .width_m = 0.15, .dash_m = 3.0, .gap_m = 6.0});
  for (double y = -5.0; y < 5.0; y += 1.0) {
    world.paint_areas.push_back({.ring = {{20.0, y}, {23.0, y}, {23.0, y + 0.5}, {20.0, y + 0.5}}});
  }
  for (const double y : {-6.0, 6.0}) {
    world.walls.push_back(
        {.base = {{-80.0, y}, {80.0, y}}, .top_m = 0.13, .texture = WallTexture::kKerbStriped});
  }
  world.parked.push_back({.centre = {12.0, 4.8}, .yaw_rad = 0.05, .albedo = {0.6F, 0.1F, 0.1F}});
  world.parked.push_back({.centre = {-10.0, -4.8}, .yaw_rad = 3.1, .kind = VehicleKind::kVan});
  world.walls.push_back(
      {.base = {{30.0, 12.0}, {50.0, 12.0}}, .top_m = 9.0, .texture = WallTexture::kFacade});
  world.posts.push_back({.position = {25.0, -9.0},
                         .radius_m = 2.0,
                         .bottom_m = 2.0,
                         .top_m = 6.0,
                         .kind = PostKind::kTreeCrown});
  world.posts.push_back({.position = {9.0, -7.0}, .top_m = 7.0});
  return world;
}

/// Even light and no noise, so that two images differ only where their worlds differ.
inline Conditions even_light() {
  Conditions conditions;
  conditions.overcast = 1.0;
  conditions.noise_sigma = 0.0;
  return conditions;
}

inline double mean_of(const RgbImage& image) {
  double sum = 0.0;
  for (const uint8_t value : image.pixels) sum += value;
  return sum / static_cast<double>(image.pixels.size());
}

}  // namespace bevloc::sim
