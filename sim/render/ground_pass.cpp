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
/// The tile directory reaches this far at the finest level.
constexpr float kReachOfFinestM =
    static_cast<float>((GroundWindow::kReachTiles - 0.5) * tile_size_m(0));

/// The constants of one image. Positions are relative to GroundWindow::local_origin().
struct ImageConstants {
  float rotation[9];  ///< map_from_camera, row by row
  float camera_x, camera_y, height;
  float pixel_angle;  ///< 1 / focal length
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
  alignas(64) float step_x[kRun], step_y[kRun];  ///< from tap to tap
  alignas(64) float texels_per_m[kRun];
  alignas(64) float blend_x[kRun], blend_y[kRun];
  alignas(64) int32_t level[kRun], tile_x[kRun], tile_y[kRun], inside[kRun], texel[kRun];
  alignas(64) float red[kRun], green[kRun], blue[kRun], gloss[kRun];
  alignas(64) float sky_red[kRun], sky_green[kRun], sky_blue[kRun];
};

/// Rotates the rays into the map and intersects them with the ground. Returns the number of taps
/// that the run needs; 0 if all pixels are sky.
BEVLOC_TARGET_CLONES
int trace_rays(const ImageConstants& constants, int count, GroundRun& run) {
  const ImageConstants& f = constants;
  const float* m = f.rotation;
  float most_ratio = 0.0F;
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    run.dx[i] = m[0] * run.rx[i] + m[1] * run.ry[i] + m[2];
    run.dy[i] = m[3] * run.rx[i] + m[4] * run.ry[i] + m[5];
    run.dz[i] = m[6] * run.rx[i] + m[7] * run.ry[i] + m[8];
    const float horizontal2 = run.dx[i] * run.dx[i] + run.dy[i] * run.dy[i] + 1e-12F;
    const float horizontal = std::sqrt(horizontal2);
    const float down = std::max(-run.dz[i], 1e-6F);
    const float t = std::min(f.height / down, kFarthestM / horizontal);
    const float range = t * horizontal;
    run.x[i] = f.camera_x + t * run.dx[i];
    run.y[i] = f.camera_y + t * run.dy[i];
    run.range[i] = range;
    run.steepness[i] = down / std::sqrt(horizontal2 + down * down);
    // The pixel's footprint on the ground: its width across and its length along the line of sight.
    const float width = t * f.pixel_angle;
    const float length = std::min(width * std::max(1.0F, range / f.height), 0.6F * range);
    const float ratio = length / std::max(width, static_cast<float>(kFinestTexelM));
    most_ratio = std::max(most_ratio, run.dz[i] < -1e-5F ? ratio : 0.0F);
    run.step_x[i] = length * run.dx[i] / horizontal;
    run.step_y[i] = length * run.dy[i] / horizontal;
    run.texels_per_m[i] = width;  // choose_levels() replaces it
  }
  if (most_ratio == 0.0F) return 0;
  return std::clamp(static_cast<int>(0.75F * most_ratio + 0.999F), 1, kMostTaps);
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
  GroundRun run;
  const int pixels = view.width() * view.height();
  for (int start = 0; start < pixels; start += kRun) {
    const int count = std::min(kRun, pixels - start);
    view.rays->get(static_cast<size_t>(start), count, run.rx, run.ry);
    const int taps = trace_rays(constants, count, run);
    const float highest = *std::max_element(run.dz, run.dz + count);
    if (taps > 0) draw_ground_run(constants, taps, count, ground, run);
    if (highest > -1e-5F) {
      shade_sky(sky, lighting,
                {run.dx, run.dy, run.dz, 1.0F / constants.pixel_angle, run.sky_red, run.sky_green,
                 run.sky_blue},
                count);
    }
    for (int i = 0; i < count; ++i) {
      const bool is_ground = run.dz[i] < -1e-5F;
      const auto at = static_cast<size_t>(start + i);
      image.red[at] = is_ground ? run.red[i] : run.sky_red[i];
      image.green[at] = is_ground ? run.green[i] : run.sky_green[i];
      image.blue[at] = is_ground ? run.blue[i] : run.sky_blue[i];
    }
  }
}

}  // namespace bevloc::sim
