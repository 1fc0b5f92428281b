#include "sim/render/sensor_pass.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "common/target_clones.h"
#include "sim/random.h"
#include "sim/render/noise.h"

namespace bevloc::sim {
namespace {

/// The inputs of develop_row().
struct RowJob {
  const float* above;
  const float* row;
  const float* below;
  const float* rx;
  const float* ry;
  const float* noise;
  float gain, blur, vignette, sigma;
  float* blended;  ///< scratch: the vertical blur
  int width;
};

/// Applies blur, vignette, gamma (sRGB, approximated by square roots) and noise. Output: 0 to 255.
BEVLOC_TARGET_CLONES
void develop_row(const RowJob& job, float* __restrict out) {
  const RowJob j = job;
  for (int i = 0; i < j.width; ++i) {
    j.blended[i] = j.row[i] + j.blur * (j.above[i] + j.below[i] - 2.0F * j.row[i]);
  }
  j.blended[-1] = j.blended[0];
  j.blended[j.width] = j.blended[j.width - 1];
  for (int i = 0; i < j.width; ++i) {
    const float* at = j.blended + i;
    const float light = at[0] + j.blur * (at[-1] + at[1] - 2.0F * at[0]);
    const float slope2 = j.rx[i] * j.rx[i] + j.ry[i] * j.ry[i];
    const float exposed = std::clamp(light * j.gain / (1.0F + j.vignette * slope2), 0.0F, 4.0F);
    // Compresses highlights instead of clipping them.
    const float toned = exposed * (1.0F + 0.08F * exposed) / (1.0F + 0.35F * exposed);
    const float root2 = std::sqrt(toned);
    const float root4 = std::sqrt(root2);
    const float root8 = std::sqrt(root4);
    const float curve = 0.585122F * root2 + 0.783140F * root4 - 0.368262F * root8;
    const float value = 255.0F * std::max(curve, 0.0F) + j.sigma * j.noise[i];
    out[i] = std::clamp(value + 0.5F, 0.0F, 255.0F);
  }
}

void store_row(const float* red, const float* green, const float* blue, int width, uint8_t* out) {
  for (int i = 0; i < width; ++i) {
    out[3 * i] = static_cast<uint8_t>(red[i]);
    out[3 * i + 1] = static_cast<uint8_t>(green[i]);
    out[3 * i + 2] = static_cast<uint8_t>(blue[i]);
  }
}

uint64_t hash_of(double value) {
  return std::bit_cast<uint64_t>(value);
}

}  // namespace

Sensor sensor_of(uint64_t world_seed, const CameraModel& camera) {
  uint64_t seed = seed_for(world_seed, "sensor");
  const Se3& mounting = camera.vehicle_from_camera;
  for (int i = 0; i < 3; ++i) {
    seed = mix_seed(seed ^ hash_of(mounting.translation_m[i]));
    seed = mix_seed(seed ^ hash_of(mounting.rotation(i, 2)));
  }
  Random random(seed);
  Sensor sensor;
  const auto level = static_cast<float>(std::exp(random.normal(0.0, 0.04)));
  const auto warmth = static_cast<float>(random.normal(0.0, 0.03));
  sensor.gain = {level * (1.0F + warmth), level, level * (1.0F - warmth)};
  sensor.blur = static_cast<float>(random.uniform(0.04, 0.13));
  sensor.vignette = static_cast<float>(random.uniform(0.12, 0.4));
  return sensor;
}

void develop(const View& view, const Lighting& lighting, const Sensor& sensor, uint64_t noise_seed,
             LinearImage& linear, RgbImage& image) {
  const int width = linear.width;
  const int height = linear.height;
  if (image.width != width || image.height != height) image = RgbImage(width, height);
  std::vector<float>& scratch = linear.scratch;
  scratch.resize(6 * static_cast<size_t>(width) + 2);
  float* blended = scratch.data() + 1;
  const auto scratch_row = [&](int i) { return scratch.data() + i * width + 2; };
  const std::array<float*, 3> rows = {scratch_row(1), scratch_row(2), scratch_row(3)};
  float* rx = scratch_row(4);
  float* ry = scratch_row(5);
  const std::array<const std::vector<float>*, 3> planes = {&linear.red, &linear.green,
                                                           &linear.blue};
  const std::array<float, 3> gains = {sensor.gain.r, sensor.gain.g, sensor.gain.b};
  uint64_t hash = mix_seed(noise_seed);
  for (int v = 0; v < height; ++v) {
    const size_t at = static_cast<size_t>(v) * static_cast<size_t>(width);
    const size_t above = v > 0 ? at - static_cast<size_t>(width) : at;
    const size_t below = v + 1 < height ? at + static_cast<size_t>(width) : at;
    view.rays->get(at, width, rx, ry);
    for (size_t c = 0; c < 3; ++c) {
      hash = mix_seed(hash);
      const float* plane = planes[c]->data();
      develop_row(
          {plane + above, plane + at, plane + below, rx, ry, GaussianTable::shared().from(hash),
           gains[c], sensor.blur, sensor.vignette, lighting.noise_sigma, blended, width},
          rows[c]);
    }
    store_row(rows[0], rows[1], rows[2], width, image.row(v));
  }
}

}  // namespace bevloc::sim
