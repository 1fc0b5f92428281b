#include "sim/render/ground_pass.h"

#include <algorithm>
#include <cmath>

#include "common/target_clones.h"
#include "sim/render/bilinear.h"
#include "sim/render/headlight.h"

namespace bevloc::sim {
namespace {

constexpr int kMostTaps = 12;
static_assert(kRun <= GroundTiles::kMostHeld, "all tiles of a run fit into the window at once");
constexpr float kFarthestM = 900.0F;
/// Curved ground hides an object if the ground is nearer than this share of the object's distance.
constexpr float kBehindGround = 0.97F;
/// The tile directory reaches this far at the finest level.
constexpr float kReachOfFinestM =
    static_cast<float>((GroundWindow::kReachTiles - 0.5) * tile_size_m(0));

/// The constants of one image. Positions are relative to GroundWindow::local_origin().
struct ImageConstants {
  float rotation[9];  ///< map_from_camera, row by row
  float camera_x, camera_y, height;
  float along, across, twist;  ///< GroundShape
  float pixel_angle;           ///< 1 / focal length
  float vehicle_x, vehicle_y, forward_x, forward_y;
  float light_x, light_y;  ///< GroundLight::origin()
  const uint32_t* light_cells;
  Lighting lighting;
};

/// The intermediate values of up to kRun consecutive pixels.
struct GroundRun {
  alignas(64) float rx[kRun], ry[kRun];            ///< rays in the camera frame
  alignas(64) float dx[kRun], dy[kRun], dz[kRun];  ///< rays in map axes
  alignas(64) float x[kRun], y[kRun], range[kRun], steepness[kRun];
  alignas(64) float step_x[kRun], step_y[kRun];  ///< step from tap to tap
  alignas(64) float texels_per_m[kRun];
  alignas(64) float blend_x[kRun], blend_y[kRun];
  alignas(64) int32_t level[kRun], tile_x[kRun], tile_y[kRun], inside[kRun], texel[kRun];
  alignas(64) float red[kRun], green[kRun], blue[kRun], gloss[kRun];
  alignas(64) float sky_red[kRun], sky_green[kRun], sky_blue[kRun];
  alignas(64) int32_t is_ground[kRun];  ///< 1 for ground, 0 for sky
  alignas(64) float nearness[kRun];     ///< 1 / t for curved ground
};

/// Rotates a ray into the map.
inline void rotate_ray(const float* m, int i, GroundRun& run) {
  run.dx[i] = m[0] * run.rx[i] + m[1] * run.ry[i] + m[2];
  run.dy[i] = m[3] * run.rx[i] + m[4] * run.ry[i] + m[5];
  run.dz[i] = m[6] * run.rx[i] + m[7] * run.ry[i] + m[8];
}

/// Sets where a ray meets the ground, at t times its length, and the footprint of its pixel there.
/// `down` is how fast the ray approaches the ground. Returns length by width of the footprint.
inline float place_footprint(const ImageConstants& f, int i, float t, float down, GroundRun& run) {
  const float horizontal2 = run.dx[i] * run.dx[i] + run.dy[i] * run.dy[i] + 1e-12F;
  const float horizontal = std::sqrt(horizontal2);
  const float range = t * horizontal;
  run.x[i] = f.camera_x + t * run.dx[i];
  run.y[i] = f.camera_y + t * run.dy[i];
  run.range[i] = range;
  run.steepness[i] = down / std::sqrt(horizontal2 + down * down);
  // The pixel's width across the line of sight, and its length along it.
  const float width = t * f.pixel_angle;
  const float length = std::min(width * std::max(1.0F, range / f.height), 0.6F * range);
  run.step_x[i] = length * run.dx[i] / horizontal;
  run.step_y[i] = length * run.dy[i] / horizontal;
  run.texels_per_m[i] = width;  // choose_levels() replaces it
  return length / std::max(width, static_cast<float>(kFinestTexelM));
}

/// The number of taps for the longest footprint of a run, or 0 if it has none.
inline int taps_of(float most_ratio) {
  if (most_ratio == 0.0F) return 0;
  return std::clamp(static_cast<int>(0.75F * most_ratio + 0.999F), 1, kMostTaps);
}

/// Rotates the rays into the map and intersects them with flat ground. Returns the number of taps
/// that the run needs, or 0 if all pixels are sky.
BEVLOC_TARGET_CLONES
int trace_rays(const ImageConstants& constants, int count, GroundRun& run) {
  const ImageConstants& f = constants;
  float most_ratio = 0.0F;
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    rotate_ray(f.rotation, i, run);
    const float horizontal = std::sqrt(run.dx[i] * run.dx[i] + run.dy[i] * run.dy[i] + 1e-12F);
    const float down = std::max(-run.dz[i], 1e-6F);
    const float t = std::min(f.height / down, kFarthestM / horizontal);
    const float ratio = place_footprint(f, i, t, down, run);
    run.is_ground[i] = run.dz[i] < -1e-5F ? 1 : 0;
    most_ratio = std::max(most_ratio, run.is_ground[i] != 0 ? ratio : 0.0F);
  }
  return taps_of(most_ratio);
}

/// Does the same with curved ground. Along a ray, at the distance u from the vehicle, the ground
/// has the height g u + k u^2 / 2, and beyond kCurvedReach_m it goes on straight.
BEVLOC_TARGET_CLONES
int trace_rays_to_curved_ground(const ImageConstants& constants, int count, GroundRun& run) {
  const ImageConstants& f = constants;
  constexpr auto kReach = static_cast<float>(kCurvedReach_m);
  // The camera in the vehicle frame, and the ground below it.
  const float to_x = f.camera_x - f.vehicle_x;
  const float to_y = f.camera_y - f.vehicle_y;
  const float at_x = to_x * f.forward_x + to_y * f.forward_y;
  const float at_y = to_y * f.forward_x - to_x * f.forward_y;
  const float below =
      0.5F * (f.along * at_x * at_x + f.across * at_y * at_y) + f.twist * at_x * at_y;
  const float above = f.height - below;
  float most_ratio = 0.0F;
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    rotate_ray(f.rotation, i, run);
    const float horizontal = std::sqrt(run.dx[i] * run.dx[i] + run.dy[i] * run.dy[i] + 1e-12F);
    const float x = (run.dx[i] * f.forward_x + run.dy[i] * f.forward_y) / horizontal;
    const float y = (run.dy[i] * f.forward_x - run.dx[i] * f.forward_y) / horizontal;
    const float bend = f.along * x * x + f.across * y * y + 2.0F * f.twist * x * y;
    const float rise = f.along * at_x * x + f.across * at_y * y + f.twist * (at_x * y + at_y * x);
    const float fall = rise - run.dz[i] / horizontal;  // towards the ground, per metre
    // Within the reach, above = fall u + bend u^2 / 2.
    const float root2 = fall * fall + 2.0F * bend * above;
    const float sum = fall + std::sqrt(std::max(root2, 0.0F));
    const float curved = root2 >= 0.0F && sum > 1e-6F ? 2.0F * above / sum : kFarthestM;
    // Beyond the reach, above = fall u + bend reach u - bend reach^2 / 2.
    const float fall_beyond = fall + bend * kReach;
    const float straight =
        fall_beyond > 1e-5F ? (above + 0.5F * bend * kReach * kReach) / fall_beyond : kFarthestM;
    const bool is_near = curved <= kReach;
    const bool is_beyond = fall_beyond > 1e-5F && straight > kReach;
    const float distance = std::min(is_near ? curved : std::max(straight, kReach), kFarthestM);
    const float down = std::max(fall + bend * std::min(distance, kReach), 1e-6F) * horizontal;
    const float ratio = place_footprint(f, i, distance / horizontal, down, run);
    run.is_ground[i] = is_near || is_beyond ? 1 : 0;
    run.nearness[i] = run.is_ground[i] != 0 ? horizontal / distance : 0.0F;
    most_ratio = std::max(most_ratio, run.is_ground[i] != 0 ? ratio : 0.0F);
  }
  return taps_of(most_ratio);
}

/// Selects the tile level of each pixel so that its taps cover its footprint.
BEVLOC_TARGET_CLONES
void choose_levels(int taps, int count, GroundRun& run) {
  const float share = 1.0F / static_cast<float>(taps);
  for (int i = 0; i < count; ++i) {
    const float width = run.texels_per_m[i];
    run.step_x[i] *= share;
    run.step_y[i] *= share;
    const float spacing = std::sqrt(run.step_x[i] * run.step_x[i] + run.step_y[i] * run.step_y[i]);
    const float reach = 1.35F * run.range[i] * static_cast<float>(kFinestTexelM) / kReachOfFinestM;
    const float texel_m = std::max(std::max(0.8F * width, 0.6F * spacing), reach);
    const float scale = texel_m * static_cast<float>(1.0 / kFinestTexelM);
    run.level[i] =
        (scale > 1.0F) + (scale > 2.0F) + (scale > 4.0F) + (scale > 8.0F) + (scale > 16.0F);
    run.texels_per_m[i] =
        static_cast<float>(1.0 / kFinestTexelM) / static_cast<float>(1 << run.level[i]);
    run.red[i] = run.green[i] = run.blue[i] = run.gloss[i] = 0.0F;
  }
}

/// Computes the tile, and the place within it, of the tap `offset` steps from the footprint's
/// centre.
BEVLOC_TARGET_CLONES
void place_taps(float offset, int count, GroundRun& run) {
  for (int i = 0; i < count; ++i) {
    const float x = (run.x[i] + offset * run.step_x[i]) * run.texels_per_m[i];
    const float y = (run.y[i] + offset * run.step_y[i]) * run.texels_per_m[i];
    const float whole_x = std::floor(x);
    const float whole_y = std::floor(y);
    run.blend_x[i] = x - whole_x;
    run.blend_y[i] = y - whole_y;
    const auto ix = static_cast<int32_t>(whole_x);
    const auto iy = static_cast<int32_t>(whole_y);
    run.tile_x[i] = ix >> kTileShift;
    run.tile_y[i] = iy >> kTileShift;
    run.inside[i] = (iy & (kTileTexels - 1)) * kTileNodes + (ix & (kTileTexels - 1));
  }
}

/// Looks up the tiles of all pixels. Returns whether all of them are in the directory.
BEVLOC_TARGET_CLONES
bool look_up(const int32_t* directory, int count, GroundRun& run) {
  int32_t lowest = 0;
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    const int32_t tile =
        directory[GroundWindow::directory_index(run.level[i], run.tile_x[i], run.tile_y[i])];
    lowest = std::min(lowest, tile);
    run.texel[i] = tile + run.inside[i];
  }
  return lowest >= 0;
}

/// Borrows the tiles that are missing in the directory.
void fetch_missing(GroundWindow& ground, int count, const GroundRun& run) {
  for (int i = 0; i < count; ++i) {
    const int32_t at = GroundWindow::directory_index(run.level[i], run.tile_x[i], run.tile_y[i]);
    if (ground.directory()[at] == GroundWindow::kMissing) {
      ground.fetch(run.level[i], run.tile_x[i], run.tile_y[i]);
    }
  }
}

/// Adds one bilinear tap to every pixel.
BEVLOC_TARGET_CLONES
void add_taps(const GroundTexel* texels, float weight, int count, GroundRun& run) {
  const NeighbourGrid grid(texels, kTileNodes);
  const float scale = weight / (255.0F * 255.0F);
  const float gloss_scale = weight / 255.0F;
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    const Neighbours near = grid.at(run.texel[i], run.blend_x[i], run.blend_y[i]);
    const float red = near.channel(0);
    const float green = near.channel(8);
    const float blue = near.channel(16);
    run.red[i] += scale * red * red;
    run.green[i] += scale * green * green;
    run.blue[i] += scale * blue * blue;
    run.gloss[i] += gloss_scale * near.channel(24);
  }
}

/// Converts albedo to radiance: sun, sky, lamps, wetness, haze.
BEVLOC_TARGET_CLONES
void light_ground(const ImageConstants& constants, int count, GroundRun& run) {
  const Lighting l = constants.lighting;
  const float sun_share = std::max(0.0F, l.to_sun.z());
  const auto per_cell = static_cast<float>(1.0 / GroundLight::kCellM);
  const float last_cell = GroundLight::kSide - 1.001F;
  const NeighbourGrid grid(constants.light_cells, GroundLight::kSide);
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    const float cell_x = std::clamp((run.x[i] - constants.light_x) * per_cell, 0.0F, last_cell);
    const float cell_y = std::clamp((run.y[i] - constants.light_y) * per_cell, 0.0F, last_cell);
    const auto ix = static_cast<int32_t>(cell_x);
    const auto iy = static_cast<int32_t>(cell_y);
    const Neighbours near = grid.at(iy * GroundLight::kSide + ix, cell_x - static_cast<float>(ix),
                                    cell_y - static_cast<float>(iy));
    const float sun = near.channel(0) * (1.0F / 255.0F) * sun_share;
    const float sky = near.channel(8) * (1.0F / 255.0F);
    const float off_x = run.x[i] - constants.vehicle_x;
    const float off_y = run.y[i] - constants.vehicle_y;
    const float ahead = off_x * constants.forward_x + off_y * constants.forward_y;
    const float aside = off_y * constants.forward_x - off_x * constants.forward_y;
    const float head = l.headlights * headlight_share(ahead, aside);
    const float lamp = l.lamps * (1.0F / 255.0F) * near.channel(16);

    const float film = l.wet * run.gloss[i];
    const float dark = 1.0F - 0.5F * film;
    const float grazing = 1.0F - run.steepness[i];
    const float grazing2 = grazing * grazing;
    const float mirror = film * sky * (0.02F + 0.5F * grazing2 * grazing2 * grazing2 * grazing2);
    const float through = 1.0F / (1.0F + run.range[i] * l.haze_per_m);
    const auto shade = [&](float albedo, float sun_c, float ambient_c, float lamp_c, float head_c,
                           float sky_c, float haze_c) {
      const float light = sun * sun_c + sky * ambient_c + lamp * lamp_c + head * head_c;
      const float lit = albedo * dark * (1.0F - mirror) * light + mirror * sky_c;
      return haze_c + through * (lit - haze_c);
    };
    run.red[i] = shade(run.red[i], l.sun.r, l.ambient.r, kLampColour.r, kHeadlightColour.r,
                       l.sky_horizon.r, l.haze.r);
    run.green[i] = shade(run.green[i], l.sun.g, l.ambient.g, kLampColour.g, kHeadlightColour.g,
                         l.sky_horizon.g, l.haze.g);
    run.blue[i] = shade(run.blue[i], l.sun.b, l.ambient.b, kLampColour.b, kHeadlightColour.b,
                        l.sky_horizon.b, l.haze.b);
  }
}

ImageConstants make_constants(const View& view, const Lighting& lighting, const GroundLight& light,
                              const Eigen::Vector2d& local_origin) {
  ImageConstants constants{};
  Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(constants.rotation) =
      view.map_from_camera;
  const Eigen::Vector2f camera = (view.position.head<2>() - local_origin).cast<float>();
  const Eigen::Vector2f vehicle = (view.vehicle - local_origin).cast<float>();
  const Eigen::Vector2f light_origin = (light.origin() - local_origin).cast<float>();
  constants.camera_x = camera.x();
  constants.camera_y = camera.y();
  constants.height = std::max(0.05F, static_cast<float>(view.position.z()));
  const GroundShape& shape = view.ground.shape();
  constants.along = static_cast<float>(shape.along_per_m);
  constants.across = static_cast<float>(shape.across_per_m);
  constants.twist = static_cast<float>(shape.twist_per_m);
  constants.pixel_angle = static_cast<float>(1.0 / view.rays->intrinsics().fx_px);
  constants.vehicle_x = vehicle.x();
  constants.vehicle_y = vehicle.y();
  constants.forward_x = view.vehicle_forward.x();
  constants.forward_y = view.vehicle_forward.y();
  constants.light_x = light_origin.x();
  constants.light_y = light_origin.y();
  constants.light_cells = light.cells();
  constants.lighting = lighting;
  return constants;
}

void draw_ground_run(const ImageConstants& constants, int taps, int count, GroundWindow& ground,
                     GroundRun& run) {
  choose_levels(taps, count, run);
  for (int tap = 0; tap < taps; ++tap) {
    place_taps(static_cast<float>(tap) - 0.5F * static_cast<float>(taps - 1), count, run);
    // Fetching a tile may replace an older one of this run, so repeat until all tiles are there.
    while (!look_up(ground.directory(), count, run)) fetch_missing(ground, count, run);
    add_taps(ground.texels(), 1.0F / static_cast<float>(taps), count, run);
  }
  light_ground(constants, count, run);
}

}  // namespace

void draw_ground_and_sky(const View& view, const Lighting& lighting, const GroundLight& light,
                         const Sky& sky, GroundWindow& ground, LinearImage& image) {
  const ImageConstants constants = make_constants(view, lighting, light, ground.local_origin());
  const bool is_flat = view.ground.shape().is_flat();
  std::fill(image.nearness.begin(), image.nearness.end(), 0.0F);
  GroundRun run;
  const int pixels = view.width() * view.height();
  for (int start = 0; start < pixels; start += kRun) {
    const int count = std::min(kRun, pixels - start);
    view.rays->get(static_cast<size_t>(start), count, run.rx, run.ry);
    const int taps = is_flat ? trace_rays(constants, count, run)
                             : trace_rays_to_curved_ground(constants, count, run);
    const bool has_sky = *std::min_element(run.is_ground, run.is_ground + count) == 0;
    if (taps > 0) draw_ground_run(constants, taps, count, ground, run);
    if (has_sky) {
      shade_sky(sky, lighting,
                {run.dx, run.dy, run.dz, 1.0F / constants.pixel_angle, run.sky_red, run.sky_green,
                 run.sky_blue},
                count);
    }
    for (int i = 0; i < count; ++i) {
      const bool is_ground = run.is_ground[i] != 0;
      const auto at = static_cast<size_t>(start + i);
      if (!is_flat) image.nearness[at] = kBehindGround * run.nearness[i];
      image.red[at] = is_ground ? run.red[i] : run.sky_red[i];
      image.green[at] = is_ground ? run.green[i] : run.sky_green[i];
      image.blue[at] = is_ground ? run.blue[i] : run.sky_blue[i];
    }
  }
}

}  // namespace bevloc::sim
