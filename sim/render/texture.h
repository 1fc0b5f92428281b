// Procedural textures of panels.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/world/world.h"

namespace bevloc::sim {

/// The textures. The first values are those of WallTexture.
enum class Pattern : uint8_t {
  kKerbPlain,
  kKerbStriped,
  kKerbPainted,
  kConcreteBarrier,
  kGuardRail,
  kHedge,
  kStoneWall,
  kFence,
  kFacade,
  kCylinder,
  kSign,
  kCrown,
  kCarSide,
  kVanSide,
  kTruckSide,
  kBusSide,
  kVehicleFront,
  kVehicleRear,
  kGlass,
  kPlain,
};
inline constexpr int kPatternCount = static_cast<int>(Pattern::kPlain) + 1;

constexpr Pattern pattern_of(WallTexture texture) {
  return static_cast<Pattern>(texture);
}
static_assert(pattern_of(WallTexture::kFacade) == Pattern::kFacade);

/// Number of storeys, and of windows per storey, in one period of Pattern::kFacade.
inline constexpr int kFacadeStoreys = 4;

inline constexpr int kTextureSide = 256;
inline constexpr int kTextureMips = 7;
inline constexpr std::array<int32_t, kTextureMips> kMipSides = [] {
  std::array<int32_t, kTextureMips> sides{};
  for (int mip = 0; mip < kTextureMips; ++mip)
    sides[static_cast<size_t>(mip)] = kTextureSide >> mip;
  return sides;
}();
/// First texel of each mip level, the finest first.
inline constexpr std::array<int32_t, kTextureMips> kMipOffsets = [] {
  std::array<int32_t, kTextureMips> offsets{};
  for (int mip = 1; mip < kTextureMips; ++mip) {
    const int side = kTextureSide >> (mip - 1);
    offsets[static_cast<size_t>(mip)] = offsets[static_cast<size_t>(mip) - 1] + side * side;
  }
  return offsets;
}();

/// A colour of a texel is (byte / 255)^2 * kTextureRange.
inline constexpr float kTextureRange = 2.0F;

/// A square texture with mip levels. The bytes of a texel, from the lowest: red, green, blue, code.
/// Codes: 0 is a hole, 128 multiplies the colour with the panel's tint, 255 keeps the colour. Row 0
/// is the lower edge of the panel.
struct Texture {
  std::vector<uint32_t> texels;
  /// Size of one period in metres; 0 if the texture is stretched over the panel.
  float period_u_m = 0.0F;
  float period_v_m = 0.0F;
};

/// A texture that shows a photograph: kTextureSide^2 colours from the lowest row, where 1 keeps the
/// panel's tint and 0 is a hole. Crowns are stretched, everything else repeats every `period_m`.
Texture texture_from(const std::vector<Rgb>& relative_colours, Pattern pattern, float period_m);

/// The textures are made at the first call. Thread-safe.
const Texture& texture_of(Pattern pattern);

}  // namespace bevloc::sim
