#include "sim/render/texture.h"

#include <algorithm>
#include <cmath>

#include "sim/random.h"
#include "sim/render/noise.h"
#include "sim/render/vehicle_profile.h"

namespace bevloc::sim {
namespace {

/// The codes of a texel (Texture).
constexpr float kHole = 0.0F;
constexpr float kTinted = 0.5F;
constexpr float kOwnColour = 1.0F;

/// A texel before it is packed.
struct Paint {
  float r, g, b;
  float code;
};

Paint tinted(float shade) {
  return {shade, shade, shade, kTinted};
}
Paint own(float r, float g, float b) {
  return {r, g, b, kOwnColour};
}
constexpr Paint kNothing{0.0F, 0.0F, 0.0F, kHole};

/// The place of a texel in its texture, with its noise: u and v are 0 to 1 from the lower left, x
/// and y are in texels.
struct Spot {
  float u, v;
  int x, y;

  /// Fine noise, about one texel wide.
  float grain() const { return GroundNoise::shared().grain(1).at(x, y); }
  /// Broad noise, about 20 texels wide. Like grain(), it repeats without a seam.
  float blotch() const {
    const NoiseField& field = GroundNoise::shared().grain(0);
    return 0.5F * (field.at(2 * x, 2 * y) + field.at(2 * x + 256, 2 * y + 256));
  }
};

/// A uniform random number in [0, 1) for an integer cell.
float cell_random(int x, int y, uint64_t salt) {
  const uint64_t hash =
      mix_seed(mix_seed(salt + static_cast<uint64_t>(x)) + static_cast<uint64_t>(y));
  return static_cast<float>(hash >> 40U) * 0x1.0p-24F;
}

Paint kerb_plain(const Spot& s) {
  const float joint = std::fmod(s.u * 4.0F, 1.0F) < 0.02F ? 0.55F : 1.0F;
  return tinted(joint * (0.85F + 0.2F * s.v + 0.06F * s.grain()));
}

Paint kerb_striped(const Spot& s) {
  const float shade = 0.9F + 0.15F * s.v + 0.06F * s.grain();
  return s.u < 0.5F ? tinted(shade) : own(0.035F * shade, 0.035F * shade, 0.035F * shade);
}

Paint kerb_painted(const Spot& s) {
  const bool chipped = s.grain() + 0.7F * s.blotch() > 1.9F;
  const float shade = 0.9F + 0.15F * s.v + 0.05F * s.grain();
  return chipped ? own(0.3F * shade, 0.29F * shade, 0.27F * shade) : tinted(shade);
}

Paint concrete_barrier(const Spot& s) {
  const float joint = std::fmod(s.u * 2.0F, 1.0F) < 0.012F ? 0.5F : 1.0F;
  const float slope = s.v < 0.35F ? 1.12F : 0.95F;  // the sloped foot faces the sky
  const float stain = std::min(1.0F, 0.72F + s.v) + 0.05F * s.blotch();
  return tinted(joint * slope * stain * (1.0F + 0.05F * s.grain()));
}

Paint guard_rail(const Spot& s) {
  if (s.v > 0.58F) {
    const float fold = std::cos((s.v - 0.58F) / 0.42F * 4.0F * 3.1416F);
    return tinted(0.85F + 0.3F * fold + 0.03F * s.grain());
  }
  const float from_post = std::abs(std::fmod(s.u * 2.0F, 1.0F) - 0.5F);
  return from_post < 0.03F ? tinted(0.6F) : kNothing;
}

Paint hedge(const Spot& s) {
  const float top = 0.86F + 0.07F * s.blotch() + 0.035F * s.grain();
  if (s.v > top) return kNothing;
  const float leaf = std::clamp(0.75F + 0.28F * s.grain() + 0.2F * s.blotch(), 0.15F, 1.7F);
  return tinted(leaf * (0.55F + 0.55F * s.v));
}

Paint stone_wall(const Spot& s) {
  constexpr int kCourses = 8;
  const int course = static_cast<int>(s.v * kCourses);
  const float shift = cell_random(course, 0, 11);
  const float along = s.u * 5.0F + shift;
  const int stone = static_cast<int>(along) % 5;
  const float from_side = std::min(along - std::floor(along), 1.0F - (along - std::floor(along)));
  const float in_course = s.v * kCourses - static_cast<float>(course);
  if (from_side < 0.04F || in_course < 0.09F) return tinted(0.55F + 0.05F * s.grain());
  return tinted(0.75F + 0.45F * cell_random(stone, course, 12) + 0.08F * s.grain());
}

Paint fence(const Spot& s) {
  const float from_bar = std::abs(std::fmod(s.u * 16.0F, 1.0F) - 0.5F);
  const bool post = std::abs(s.u - 0.5F) < 0.02F;
  const bool rail = std::abs(s.v - 0.12F) < 0.025F || std::abs(s.v - 0.88F) < 0.025F;
  return from_bar < 0.13F || post || rail ? tinted(0.9F + 0.1F * s.grain()) : kNothing;
}

/// kFacadeStoreys storeys with kFacadeStoreys windows each.
Paint facade(const Spot& s) {
  const float bay = s.u * kFacadeStoreys;
  const float storey = s.v * kFacadeStoreys;
  const int bay_index = static_cast<int>(bay);
  const int storey_index = static_cast<int>(storey);
  const float x = bay - static_cast<float>(bay_index);
  const float y = storey - static_cast<float>(storey_index);
  const float wall = 0.95F + 0.05F * s.grain() + 0.05F * s.blotch();
  if (y < 0.035F) return tinted(0.7F * wall);
  const bool frame = std::abs(x - 0.5F) < 0.25F && y > 0.27F && y < 0.80F;
  const bool pane =
      std::abs(x - 0.5F) < 0.215F && y > 0.31F && y < 0.77F && std::abs(x - 0.5F) > 0.012F;
  if (!frame) return tinted(wall);
  if (!pane) return own(0.45F, 0.44F, 0.42F);
  const float pick = cell_random(bay_index, storey_index, 21);
  if (pick < 0.2F) return own(0.50F, 0.40F, 0.24F);  // curtains, lit at night
  const float sheen = 0.05F + 0.10F * pick * (0.5F + y);
  return own(0.8F * sheen, 0.95F * sheen, 1.15F * sheen);
}

Paint cylinder(const Spot& s) {
  const float across = 2.0F * s.u - 1.0F;
  return tinted(0.55F + 0.5F * std::sqrt(std::max(0.0F, 1.0F - across * across)) +
                0.06F * s.grain());
}

Paint sign(const Spot& s) {
  const float edge = std::min(std::min(s.u, 1.0F - s.u), std::min(s.v, 1.0F - s.v));
  if (edge < 0.09F) return own(0.75F, 0.75F, 0.75F);
  const bool mark = std::abs(s.u - 0.5F) < 0.11F && std::abs(s.v - 0.5F) < 0.3F;
  return mark ? own(0.75F, 0.75F, 0.75F) : tinted(1.0F);
}

Paint crown(const Spot& s) {
  const float dx = 2.0F * s.u - 1.0F;
  const float dy = 2.0F * s.v - 1.0F;
  const float edge = 0.86F + 0.10F * s.blotch() + 0.05F * s.grain();
  const float radius = std::sqrt(dx * dx + dy * dy);
  if (radius > edge || (radius > 0.45F && s.grain() > 1.5F)) return kNothing;
  const float leaf = std::clamp(0.7F + 0.3F * s.grain() + 0.3F * s.blotch(), 0.1F, 1.8F);
  return tinted(leaf * (0.6F + 0.45F * s.v));
}

struct Wheels {
  float rear_x, front_x;
  float radius_x, radius_z;  ///< radii as shares of length and height
};

/// Side windows within [x_from, x_to] x [z_from, z_to], divided into `panes` panes.
struct Windows {
  float x_from, x_to, z_from, z_to;
  int panes;
};

Paint vehicle_side(const Spot& s, VehicleKind kind, const Wheels& wheels, const Windows& windows) {
  for (const float x : {wheels.rear_x, wheels.front_x}) {
    const float distance =
        std::hypot((s.u - x) / wheels.radius_x, (s.v - wheels.radius_z) / wheels.radius_z);
    if (distance < 0.55F) return own(0.25F, 0.25F, 0.26F);
    if (distance < 1.0F) return own(0.018F, 0.018F, 0.018F);
    if (distance < 1.12F && s.v < 0.6F) return own(0.03F, 0.03F, 0.03F);
  }
  const VehicleProfile& profile = profile_of(kind);
  if (!inside_profile(profile.corners, s.u, s.v)) return kNothing;
  const bool in_band = s.u > windows.x_from && s.u < windows.x_to && s.v > windows.z_from &&
                       s.v < windows.z_to &&
                       inside_profile(profile.corners, s.u - 0.025F, s.v + 0.05F) &&
                       inside_profile(profile.corners, s.u + 0.025F, s.v + 0.05F);
  const float pane =
      (s.u - windows.x_from) / (windows.x_to - windows.x_from) * static_cast<float>(windows.panes);
  if (in_band && pane - std::floor(pane) > 0.06F) {
    return own(0.035F + 0.03F * s.v, 0.04F + 0.035F * s.v, 0.05F + 0.04F * s.v);
  }
  const bool sill = s.v < 0.22F;
  return tinted((sill ? 0.45F : 0.85F) + (s.v < 0.5F ? 0.0F : 0.12F));
}

Paint car_side(const Spot& s) {
  return vehicle_side(s, VehicleKind::kCar, {0.19F, 0.81F, 0.073F, 0.215F},
                      {0.14F, 0.74F, 0.65F, 0.93F, 2});
}
Paint van_side(const Spot& s) {
  return vehicle_side(s, VehicleKind::kVan, {0.2F, 0.82F, 0.068F, 0.165F},
                      {0.6F, 0.85F, 0.58F, 0.88F, 1});
}
Paint truck_side(const Spot& s) {
  return vehicle_side(s, VehicleKind::kTruck, {0.16F, 0.86F, 0.06F, 0.145F},
                      {0.82F, 0.97F, 0.52F, 0.74F, 1});
}
Paint bus_side(const Spot& s) {
  return vehicle_side(s, VehicleKind::kBus, {0.24F, 0.80F, 0.042F, 0.15F},
                      {0.02F, 0.98F, 0.42F, 0.86F, 7});
}

Paint vehicle_front(const Spot& s) {
  const float from_middle = std::abs(s.u - 0.5F);
  if (from_middle > 0.29F && from_middle < 0.46F && s.v > 0.52F && s.v < 0.86F)
    return own(0.9F, 0.87F, 0.8F);
  if (from_middle < 0.13F && s.v > 0.12F && s.v < 0.34F) return own(0.3F, 0.3F, 0.28F);
  if (from_middle < 0.3F && s.v > 0.4F && s.v < 0.8F) return own(0.03F, 0.03F, 0.03F);
  return tinted(s.v < 0.3F ? 0.5F : 0.9F);
}

Paint vehicle_rear(const Spot& s) {
  const float from_middle = std::abs(s.u - 0.5F);
  if (from_middle > 0.36F && from_middle < 0.48F && s.v > 0.45F && s.v < 0.82F)
    return own(0.55F, 0.025F, 0.02F);
  if (from_middle < 0.14F && s.v > 0.3F && s.v < 0.5F) return own(0.3F, 0.3F, 0.28F);
  return tinted(s.v < 0.2F ? 0.45F : 0.9F);
}

Paint glass(const Spot& s) {
  const bool frame = s.u < 0.05F || s.u > 0.95F;
  return frame ? tinted(0.8F) : own(0.06F + 0.05F * s.v, 0.07F + 0.055F * s.v, 0.08F + 0.06F * s.v);
}

Paint plain(const Spot& s) {
  return tinted(1.0F + 0.01F * s.grain());
}

/// How to make the texture of a pattern.
struct Recipe {
  Paint (*paint)(const Spot&);
  float period_u_m;
  float period_v_m;
};

/// The recipes in the order of Pattern.
constexpr std::array<Recipe, kPatternCount> kRecipes = {{
    {kerb_plain, 4.0F, 0.0F},    {kerb_striped, 2.0F, 0.0F},
    {kerb_painted, 6.0F, 0.0F},  {concrete_barrier, 6.0F, 0.0F},
    {guard_rail, 4.0F, 0.0F},    {hedge, 5.0F, 0.0F},
    {stone_wall, 2.5F, 2.0F},    {fence, 2.0F, 0.0F},
    {facade, 12.8F, 12.8F},      {cylinder, 0.0F, 0.0F},
    {sign, 0.0F, 0.0F},          {crown, 0.0F, 0.0F},
    {car_side, 0.0F, 0.0F},      {van_side, 0.0F, 0.0F},
    {truck_side, 0.0F, 0.0F},    {bus_side, 0.0F, 0.0F},
    {vehicle_front, 0.0F, 0.0F}, {vehicle_rear, 0.0F, 0.0F},
    {glass, 0.0F, 0.0F},         {plain, 0.0F, 0.0F},
}};

uint32_t pack(const Paint& paint) {
  const auto byte = [](float value) {
    return static_cast<uint32_t>(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F)));
  };
  const auto colour = [byte](float value) {
    return byte(std::sqrt(std::max(0.0F, value) / kTextureRange));
  };
  return colour(paint.r) | colour(paint.g) << 8U | colour(paint.b) << 16U | byte(paint.code) << 24U;
}

/// Averages 2 x 2 texels. Holes do not contribute to the colour.
std::vector<Paint> halved(const std::vector<Paint>& finer, int finer_side) {
  const int side = finer_side / 2;
  std::vector<Paint> result;
  result.reserve(static_cast<size_t>(side) * side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      Paint sum{};
      float weight = 0.0F;
      for (const int at : {0, 1, finer_side, finer_side + 1}) {
        const Paint& p = finer[static_cast<size_t>(2 * y) * finer_side + 2 * x + at];
        const float w = p.code == kHole ? 0.0F : 1.0F;
        sum.r += w * p.r;
        sum.g += w * p.g;
        sum.b += w * p.b;
        sum.code += 0.25F * p.code;
        weight += w;
      }
      const float scale = weight > 0.0F ? 1.0F / weight : 0.0F;
      result.push_back({scale * sum.r, scale * sum.g, scale * sum.b, sum.code});
    }
  }
  return result;
}

/// Packs the texels and their mip levels.
Texture packed(std::vector<Paint> texels, float period_u_m, float period_v_m) {
  Texture texture;
  texture.period_u_m = period_u_m;
  texture.period_v_m = period_v_m;
  texture.texels.reserve(kMipOffsets.back() + kMipSides.back() * kMipSides.back());
  for (int mip = 0; mip < kTextureMips; ++mip) {
    if (mip > 0) texels = halved(texels, kTextureSide >> (mip - 1));
    for (const Paint& paint : texels) texture.texels.push_back(pack(paint));
  }
  return texture;
}

Texture make_texture(const Recipe& recipe) {
  std::vector<Paint> texels;
  texels.reserve(static_cast<size_t>(kTextureSide) * kTextureSide);
  for (int y = 0; y < kTextureSide; ++y) {
    for (int x = 0; x < kTextureSide; ++x) {
      const auto share = [](int i) { return (static_cast<float>(i) + 0.5F) / kTextureSide; };
      texels.push_back(recipe.paint({share(x), share(y), x, y}));
    }
  }
  return packed(std::move(texels), recipe.period_u_m, recipe.period_v_m);
}

}  // namespace

Texture texture_from(const std::vector<Rgb>& relative_colours, Pattern pattern, float period_m) {
  std::vector<Paint> texels;
  for (const Rgb& colour : relative_colours) {
    const bool hole = colour.r + colour.g + colour.b <= 0.0F;
    texels.push_back(hole ? kNothing : Paint{colour.r, colour.g, colour.b, kTinted});
  }
  const bool stretched = pattern == Pattern::kCrown;
  return packed(std::move(texels), stretched ? 0.0F : period_m, stretched ? 0.0F : period_m);
}

const Texture& texture_of(Pattern pattern) {
  static const std::array<Texture, kPatternCount> textures = [] {
    std::array<Texture, kPatternCount> made;
    for (size_t i = 0; i < made.size(); ++i) made[i] = make_texture(kRecipes[i]);
    return made;
  }();
  return textures[static_cast<size_t>(pattern)];
}

}  // namespace bevloc::sim
