#include "sim/render/sky.h"

#include <algorithm>
#include <cmath>

#include "common/target_clones.h"
#include "sim/random.h"
#include "sim/render/noise.h"

namespace bevloc::sim {
namespace {

/// Index of a direction in the skyline, in [0, kSkylineSize): a cheap substitute for the azimuth.
inline int32_t skyline_place(float dx, float dy) {
  const float sum = std::abs(dx) + std::abs(dy) + 1e-9F;
  const float quarter = dy / sum;
  const float turn = dx < 0.0F ? 2.0F - quarter : quarter;  // -1 to 3
  const auto place = static_cast<int32_t>((turn + 1.0F) * (0.25F * Sky::kSkylineSize));
  return std::min(std::max(place, 0), Sky::kSkylineSize - 1);
}

BEVLOC_TARGET_CLONES
void shade_run(const Sky& sky, const Lighting& lighting, const SkyRun& run, int count) {
  const NoiseField& field = GroundNoise::shared().patches();
  const float* clouds = field.row(0, 0);
  const float* clouds_right = clouds + 1;
  const auto pitch = static_cast<int32_t>(field.pitch());
  const int32_t mask = field.period() - 1;
  const Lighting l = lighting;
  const float cloud_contrast = 0.03F + 0.32F * l.overcast * (1.1F - l.overcast);
  const float glare = 1.0F - l.overcast;
  const float* skyline = sky.skyline();
  const float* shades = sky.skyline_shade();
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    const float horizontal = std::sqrt(run.dx[i] * run.dx[i] + run.dy[i] * run.dy[i]) + 1e-6F;
    const float length = std::sqrt(horizontal * horizontal + run.dz[i] * run.dz[i]);
    const float tangent = run.dz[i] / horizontal;
    const float up = std::max(0.0F, run.dz[i] / length);
    const float low_down = (1.0F - up) * (1.0F - up);
    const float high = 1.0F - low_down * low_down;
    // The clouds lie on a plane overhead. Towards the horizon they blur into each other.
    const float plane = 34.0F / (up + 0.10F) / length;
    const float x = run.dx[i] * plane + 4096.0F;
    const float y = run.dy[i] * plane + 4096.0F;
    const auto cell_x = static_cast<int32_t>(x);
    const auto cell_y = static_cast<int32_t>(y);
    const float blend_x = x - static_cast<float>(cell_x);
    const float blend_y = y - static_cast<float>(cell_y);
    const int32_t below = (cell_y & mask) * pitch + (cell_x & mask);
    const int32_t above = ((cell_y + 1) & mask) * pitch + (cell_x & mask);
    const float cloud_low = clouds[below] + blend_x * (clouds_right[below] - clouds[below]);
    const float cloud_high = clouds[above] + blend_x * (clouds_right[above] - clouds[above]);
    const float cloud = cloud_low + blend_y * (cloud_high - cloud_low);
    const float to_sun = std::max(
        0.0F,
        (run.dx[i] * l.to_sun.x() + run.dy[i] * l.to_sun.y() + run.dz[i] * l.to_sun.z()) / length);
    const float sun4 = to_sun * to_sun * to_sun * to_sun;
    const float sun16 = sun4 * sun4 * sun4 * sun4;
    const float light = 1.0F + cloud_contrast * cloud * std::min(1.0F, 4.0F * up);
    const float halo = glare * (0.12F * sun4 + 0.9F * sun16 * sun16);
    const int32_t place = skyline_place(run.dx[i], run.dy[i]);
    const float cover =
        std::clamp((skyline[place] - tangent) * run.sharpness_px + 0.5F, 0.0F, 1.0F);
    const float shade = shades[place];
    const auto channel = [&](float zenith, float horizon, float sun, float ambient, float haze,
                             float hue) {
      const float open = (horizon + (zenith - horizon) * high) * light + halo * sun;
      const float far = 0.45F * haze + 0.55F * ambient * shade * hue;
      return open + cover * (far - open);
    };
    run.red[i] = channel(l.sky_zenith.r, l.sky_horizon.r, l.sun.r, l.ambient.r, l.haze.r, 0.9F);
    run.green[i] = channel(l.sky_zenith.g, l.sky_horizon.g, l.sun.g, l.ambient.g, l.haze.g, 1.0F);
    run.blue[i] = channel(l.sky_zenith.b, l.sky_horizon.b, l.sun.b, l.ambient.b, l.haze.b, 0.85F);
  }
}

}  // namespace

Sky::Sky(uint64_t world_seed) {
  Random random(seed_for(world_seed, "skyline"));
  // Blocks of houses between stretches of woods.
  int at = 0;
  while (at < kSkylineSize) {
    const bool house = random.chance(0.55);
    const int width = random.integer(6, house ? 34 : 60);
    const double height = house ? random.uniform(0.012, 0.075) : random.uniform(0.015, 0.035);
    const double shade = house ? random.uniform(0.12, 0.40) : random.uniform(0.05, 0.10);
    for (int i = 0; i < width && at < kSkylineSize; ++i, ++at) {
      const double ragged = house ? 0.0 : random.normal(0.0, 0.003);
      skyline_[static_cast<size_t>(at)] = static_cast<float>(height + ragged);
      shade_[static_cast<size_t>(at)] = static_cast<float>(shade);
    }
  }
}

void shade_sky(const Sky& sky, const Lighting& lighting, const SkyRun& run, int count) {
  shade_run(sky, lighting, run, count);
}

}  // namespace bevloc::sim
