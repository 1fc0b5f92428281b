#include "sim/render/lighting.h"

#include <algorithm>
#include <cmath>

#include "common/se2.h"
#include "sim/world/path.h"

namespace bevloc::sim {
namespace {

float ramp(double from, double to, double value) {
  return static_cast<float>(smooth_step(from, to, value));
}

float luma(const Rgb& c) {
  return 0.25F * c.r + 0.6F * c.g + 0.15F * c.b;
}

constexpr Rgb kLowSun{1.0F, 0.62F, 0.34F};
constexpr Rgb kHighSun{1.0F, 0.96F, 0.88F};
constexpr Rgb kClearSky{0.33F, 0.47F, 0.75F};
constexpr Rgb kCloud{0.70F, 0.72F, 0.75F};
constexpr Rgb kNightSky{0.010F, 0.0105F, 0.013F};

}  // namespace

Lighting lighting_of(const Conditions& conditions) {
  const double elevation = conditions.sun_elevation_rad;
  const auto overcast = static_cast<float>(std::clamp(conditions.overcast, 0.0, 1.0));
  const auto rain = static_cast<float>(std::clamp(conditions.rain, 0.0, 1.0));
  const float daylight = ramp(radians(-9.0), radians(14.0), elevation);
  const float night = 1.0F - ramp(radians(-8.0), radians(1.0), elevation);

  Lighting light;
  light.to_sun = Eigen::Vector3d(std::cos(elevation) * std::cos(conditions.sun_azimuth_rad),
                                 std::cos(elevation) * std::sin(conditions.sun_azimuth_rad),
                                 std::sin(elevation))
                     .cast<float>();
  light.overcast = overcast;
  light.wet = rain;
  const float warmth = ramp(radians(2.0), radians(30.0), elevation);
  const float direct =
      1.25F * ramp(0.0, radians(22.0), elevation) * std::pow(1.0F - overcast, 1.3F);
  light.sun = direct * mix(kLowSun, kHighSun, warmth);
  const Rgb dome = mix(kClearSky, kCloud, 0.2F + 0.8F * overcast);
  // Rain clouds absorb light.
  light.ambient = (0.62F * daylight * (1.0F - 0.45F * rain)) * dome + kNightSky;

  // The automatic exposure compensates most of the missing light, not all of it.
  const float incident = luma(light.ambient) + luma(light.sun) * std::max(0.0F, light.to_sun.z());
  const float gain = static_cast<float>(conditions.exposure) * 1.55F /
                     std::pow(incident + 0.012F, 0.82F) * (1.0F - 0.6F * night);
  const Rgb horizon =
      mix(mix({0.75F, 0.80F, 0.88F}, {0.95F, 0.66F, 0.45F}, (1.0F - overcast) * (1.0F - warmth)),
          {0.74F, 0.75F, 0.77F}, overcast);
  light.sky_horizon =
      ((0.98F - 0.26F * overcast) * gain * daylight * (1.0F - 0.5F * rain)) * horizon +
      (gain * 0.5F) * kNightSky;
  light.sky_zenith = ((0.80F - 0.18F * overcast) * gain * daylight * (1.0F - 0.45F * rain)) * dome +
                     (gain * 0.2F) * kNightSky;
  light.haze = 0.85F * mix(light.sky_horizon, light.ambient, 0.5F);
  light.haze_per_m = 1.0F / std::lerp(900.0F, 180.0F, rain) + 0.0008F * overcast;
  light.sun = gain * light.sun;
  light.ambient = gain * light.ambient;
  light.headlights = 3.6F * night * static_cast<float>(conditions.exposure);
  light.lamps = 1.1F * night * static_cast<float>(conditions.exposure);
  light.glow = 1.3F * night;
  light.noise_sigma = static_cast<float>(conditions.noise_sigma) * (1.0F + 0.8F * night);
  return light;
}

}  // namespace bevloc::sim
