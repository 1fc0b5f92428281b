// Small procedural pictures that clothe upright sheets.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/world/world.h"

namespace bevloc::sim {

/// What is on the sheet; the first ones follow WallTexture.
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

/// Storeys and bays in one repetition of Pattern::kFacade.
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

/// A texel's colours are (byte / 255)^2 * kTextureRange.
inline constexpr float kTextureRange = 2.0F;

/// Red, green, blue from the low byte up and, in the top byte, a code: 0 is a hole, 128 takes the
/// sheet's tint, 255 keeps its own colour. Row 0 is the foot of the sheet.
struct Texture {
  std::vector<uint32_t> texels;
  /// Width in metres of one repetition, or 0 to stretch over the sheet.
  float period_u_m = 0.0F;
  float period_v_m = 0.0F;
};

/// Made once in the life of the process; safe from any thread.
const Texture& texture_of(Pattern pattern);

}  // namespace bevloc::sim
