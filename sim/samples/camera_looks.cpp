#include "sim/samples/camera_looks.h"

#include <algorithm>
#include <cmath>

#include "sim/random.h"

namespace bevloc::sim {
namespace {

/// How much the cameras of one vehicle differ, as a share of the range of all vehicles.
constexpr double kOwnShare = 0.15;
constexpr double kBodyInPicture = 0.6;  ///< the share of a vehicle's cameras that see its body
constexpr double kHighestBody = 0.22;   ///< share of the picture's height
constexpr int kMostBlackRows = 5;
constexpr int kMostSmear_px = 2;

/// Draws a factor from 1 / (1 + most) to 1 + most. Its logarithm is uniform.
float random_factor(double most, Random& random) {
  const double limit = std::log1p(most);
  return static_cast<float>(std::exp(random.uniform(-limit, limit)));
}

PictureLook common_look(const CameraLooks& looks, Random& random) {
  PictureLook look;
  for (float& gain : look.gain) gain = random_factor(looks.cast, random);
  look.saturation =
      static_cast<float>(random.uniform(looks.least_saturation, looks.most_saturation));
  if (random.chance(looks.grey_share)) look.saturation = 0.0F;
  look.contrast = random_factor(looks.contrast, random);
  look.gamma = random_factor(looks.contrast, random);
  look.sharpening = static_cast<float>(random.uniform(-looks.sharpness, looks.sharpness));
  const int smear_px = random.integer(1, kMostSmear_px);
  look.smear_px = random.chance(looks.smear_share) ? smear_px : 0;
  const int black_rows = random.integer(1, kMostBlackRows);
  look.black_rows = random.chance(looks.black_rows_share) ? black_rows : 0;
  return look;
}

Bodywork random_bodywork(Random& random) {
  Bodywork body;
  body.middle = static_cast<float>(random.uniform(0.0, kHighestBody));
  body.left = static_cast<float>(random.uniform(0.0, kHighestBody));
  body.right =
      random.chance(0.5) ? body.left : static_cast<float>(random.uniform(0.0, kHighestBody));
  return body;
}

}  // namespace

CameraLooks scaled(const CameraLooks& looks, double factor) {
  const auto share = [factor](double value) { return std::min(factor * value, 1.0); };
  return {.cast = factor * looks.cast,
          .least_saturation = std::max(1.0 + factor * (looks.least_saturation - 1.0), 0.0),
          .most_saturation = 1.0 + factor * (looks.most_saturation - 1.0),
          .grey_share = share(looks.grey_share),
          .contrast = factor * looks.contrast,
          .sharpness = factor * looks.sharpness,
          .smear_share = share(looks.smear_share),
          .body_share = share(looks.body_share),
          .black_rows_share = share(looks.black_rows_share)};
}

std::array<PictureLook, kCameraCount> random_looks(const CameraLooks& looks, uint64_t seed) {
  Random random(seed_for(seed, "looks"));
  const PictureLook common = common_look(looks, random);
  const bool has_body = random.chance(looks.body_share);
  std::array<float, 3> paint{};
  const double brightness = random.uniform(5.0, 200.0);
  for (float& colour : paint) {
    colour = static_cast<float>(brightness) * random_factor(0.3, random);
  }
  const auto shine = static_cast<float>(random.uniform(0.0, 0.6));
  std::array<PictureLook, kCameraCount> drawn;
  for (PictureLook& look : drawn) {
    look = common;
    for (float& gain : look.gain) gain *= random_factor(kOwnShare * looks.cast, random);
    look.contrast *= random_factor(kOwnShare * looks.contrast, random);
    const Bodywork body = random_bodywork(random);
    if (!random.chance(kBodyInPicture) || !has_body) continue;
    look.bodywork = body;
    look.bodywork.colour = paint;
    look.bodywork.shine = shine;
  }
  return drawn;
}

}  // namespace bevloc::sim
