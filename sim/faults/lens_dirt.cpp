#include "sim/faults/lens_dirt.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>

#include "sim/random.h"

namespace bevloc::sim {
namespace {

constexpr int kMostSpots = 2000;
/// Radius of a spot, relative to the picture's height.
constexpr double kSmallest = 0.03;
constexpr double kLargest = 0.20;
/// The part of a spot's radius over which it fades out: dirt is too near to be in focus.
constexpr double kSoftPart = 0.5;
/// Colour of mud relative to the light behind it.
constexpr std::array<double, 3> kMud = {0.62, 0.55, 0.45};

}  // namespace

LensDirt::LensDirt(int width_px, int height_px, double share, uint64_t seed)
    : share_(share),
      opacity_(static_cast<size_t>(width_px) * static_cast<size_t>(height_px), 0.0F) {
  Random random(seed_for(seed, "lens dirt"));
  for (int spot = 0; spot < kMostSpots && covered() < share; ++spot) {
    const double centre_u = random.uniform(0.0, width_px);
    const double centre_v = random.uniform(0.0, height_px);
    const double radius_px = height_px * random.uniform(kSmallest, kLargest);
    const auto first = [radius_px](double centre) {
      return std::max(0, static_cast<int>(centre - radius_px));
    };
    const auto end = [radius_px](double centre, int size) {
      return std::min(size, static_cast<int>(centre + radius_px) + 2);
    };
    for (int v = first(centre_v); v < end(centre_v, height_px); ++v) {
      for (int u = first(centre_u); u < end(centre_u, width_px); ++u) {
        const double distance = std::hypot(u - centre_u, v - centre_v) / radius_px;
        const auto opacity = static_cast<float>(std::clamp((1.0 - distance) / kSoftPart, 0.0, 1.0));
        float& known = opacity_[static_cast<size_t>(v) * static_cast<size_t>(width_px) +
                                static_cast<size_t>(u)];
        known = std::max(known, opacity);
      }
    }
  }
}

double LensDirt::covered() const {
  const double sum = std::accumulate(opacity_.begin(), opacity_.end(), 0.0);
  return opacity_.empty() ? 0.0 : sum / static_cast<double>(opacity_.size());
}

void LensDirt::cover(RgbImage& image) const {
  assert(static_cast<size_t>(image.width) * image.height == opacity_.size());
  const uint64_t sum = std::accumulate(image.pixels.begin(), image.pixels.end(), uint64_t{0});
  const double mean = static_cast<double>(sum) / static_cast<double>(image.pixels.size());
  for (size_t i = 0; i < opacity_.size(); ++i) {
    if (opacity_[i] <= 0.0F) continue;
    for (size_t channel = 0; channel < kMud.size(); ++channel) {
      uint8_t& pixel = image.pixels[3 * i + channel];
      const double mixed =
          std::lerp(static_cast<double>(pixel), kMud[channel] * mean, double{opacity_[i]});
      pixel = static_cast<uint8_t>(std::lround(mixed));
    }
  }
}

}  // namespace bevloc::sim
