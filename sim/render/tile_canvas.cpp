#include "sim/render/tile_canvas.h"

#include <algorithm>
#include <cmath>

#include "common/target_clones.h"
#include "sim/random.h"
#include "sim/render/paint_wear.h"

namespace bevloc::sim {
namespace {

struct Material {
  Rgb albedo;
  float gloss;
  float grain;    ///< contrast of the fine noise
  float patches;  ///< contrast over metres
  Rgb patch_hue;  ///< added where the patch noise is 1
  double slab_m;  ///< distance between joints; 0 without joints
};

const Material& material_of(GroundMaterial material) {
  static const std::array<Material, 6> kMaterials = {{
      {{0.115F, 0.114F, 0.113F}, 1.0F, 0.12F, 0.08F, {}, 0.0},
      {{0.33F, 0.32F, 0.295F}, 0.7F, 0.06F, 0.06F, {}, 3.2},
      {{0.25F, 0.235F, 0.22F}, 0.6F, 0.09F, 0.07F, {0.006F, 0.0F, -0.004F}, 0.4},
      {{0.060F, 0.088F, 0.030F}, 0.08F, 0.30F, 0.20F, {0.016F, 0.004F, 0.003F}, 0.0},
      {{0.170F, 0.132F, 0.090F}, 0.15F, 0.18F, 0.18F, {0.01F, 0.0F, -0.005F}, 0.0},
      {{0.235F, 0.225F, 0.205F}, 0.2F, 0.30F, 0.10F, {}, 0.0},
  }};
  return kMaterials[static_cast<size_t>(material)];
}

/// Factors on a material's albedo along a row.
struct PhotoRow {
  std::array<float, kTileNodes> red, green, blue;
};

/// `photo` may be null; then all factors are 1.
PhotoRow photo_row(const TileCanvas& canvas, int j, const GroundPhoto* photo) {
  PhotoRow row;
  if (photo == nullptr) {
    for (auto* channel : {&row.red, &row.green, &row.blue}) channel->fill(1.0F);
  } else {
    photo->copy_row(canvas.key.level, canvas.key.ix * kTileTexels, canvas.key.iy * kTileTexels + j,
                    kTileNodes, row.red.data(), row.green.data(), row.blue.data());
  }
  return row;
}

BEVLOC_TARGET_CLONES
void fill_row(const CanvasRow& row, const Material& material, float brightness,
              const PhotoRow& photo, const float* coverage) {
  float* __restrict red = row.red;
  float* __restrict green = row.green;
  float* __restrict blue = row.blue;
  float* __restrict gloss = row.gloss;
  const Material m = material;
#pragma GCC ivdep
  for (int i = 0; i < kTileNodes; ++i) {
    const float shade =
        std::max(0.3F, brightness * (1.0F + m.grain * row.grain[i] + m.patches * row.patches[i]));
    const float hue = brightness * row.patches[i];
    const float cover = coverage[i];
    red[i] += cover * (shade * photo.red[i] * m.albedo.r + hue * m.patch_hue.r - red[i]);
    green[i] += cover * (shade * photo.green[i] * m.albedo.g + hue * m.patch_hue.g - green[i]);
    blue[i] += cover * (shade * photo.blue[i] * m.albedo.b + hue * m.patch_hue.b - blue[i]);
    gloss[i] += cover * (m.gloss - gloss[i]);
  }
}

BEVLOC_TARGET_CLONES
void paint_row(const CanvasRow& row, const Rgb& albedo, float wear, const float* coverage) {
  float* __restrict red = row.red;
  float* __restrict green = row.green;
  float* __restrict blue = row.blue;
  const PaintWear worn(wear);
#pragma GCC ivdep
  for (int i = 0; i < kTileNodes; ++i) {
    const float cover = coverage[i] * worn.kept(row.grain[i], row.patches[i]);
    const float shade = worn.shade(row.grain[i]);
    red[i] += cover * (shade * albedo.r - red[i]);
    green[i] += cover * (shade * albedo.g - green[i]);
    blue[i] += cover * (shade * albedo.b - blue[i]);
  }
}

/// Interpolates the nodes at start, start + step, ...
BEVLOC_TARGET_CLONES
void stretch_row(const float* nodes, float start, float step, float* __restrict out) {
#pragma GCC ivdep
  for (int i = 0; i < kTileNodes; ++i) {
    const float x = start + static_cast<float>(i) * step;
    const auto cell = static_cast<int32_t>(x);
    const float blend = x - static_cast<float>(cell);
    out[i] = nodes[cell] + blend * (nodes[cell + 1] - nodes[cell]);
  }
}

/// Draws dark joints between slabs if the texels are fine enough to show them.
void draw_joints(TileCanvas& canvas, int j, double slab_m, const float* coverage) {
  constexpr float kJointShade = 0.22F;
  const auto period = static_cast<int64_t>(std::lround(slab_m / canvas.texel_m()));
  if (period < 4) return;
  const CanvasRow row = canvas_row(canvas, j, 0);
  const auto darken = [&](int i) {
    const float keep = 1.0F - kJointShade * coverage[i];
    row.red[i] *= keep;
    row.green[i] *= keep;
    row.blue[i] *= keep;
  };
  const auto phase = [period](int64_t index) { return ((index % period) + period) % period; };
  if (phase(canvas.key.iy * kTileTexels + j) == 0) {
    for (int i = 0; i < kTileNodes; ++i) darken(i);
  }
  const int64_t first = (period - phase(canvas.key.ix * kTileTexels)) % period;
  for (int64_t i = first; i < kTileNodes; i += period) darken(static_cast<int>(i));
}

const std::array<float, kTileNodes>& full_coverage() {
  static const std::array<float, kTileNodes> ones = [] {
    std::array<float, kTileNodes> values{};
    values.fill(1.0F);
    return values;
  }();
  return ones;
}

}  // namespace

TileCanvas::TileCanvas()
    : red(kTileArea), green(kTileArea), blue(kTileArea), gloss(kTileArea), patches(kTileArea) {}

void TileCanvas::begin(const TileKey& tile, uint64_t world_seed) {
  key = tile;
  // The shifts are multiples of the coarsest texel, so that the noise is aligned at all levels.
  const auto shift = [&](uint64_t hash) {
    return static_cast<int64_t>(hash % 256U) << (kGroundLevels - 1 - key.level);
  };
  noise_shift_x_ = shift(seed_for(world_seed, "noise x"));
  noise_shift_y_ = shift(seed_for(world_seed, "noise y"));

  for (Plane* plane : {&red, &green, &blue, &gloss}) std::fill(plane->begin(), plane->end(), 0.0F);
  for (int j = 0; j < kTileNodes; ++j) look_up_patches(j);
}

void TileCanvas::look_up_patches(int j) {
  const NoiseField& field = GroundNoise::shared().patches();
  const double scale = texel_m() / GroundNoise::kPatchSpacingM;
  const double x0 = static_cast<double>(key.ix * kTileTexels + noise_shift_x_) * scale;
  const double y = static_cast<double>(key.iy * kTileTexels + j + noise_shift_y_) * scale;
  const auto ix = static_cast<int64_t>(std::floor(x0));
  const auto iy = static_cast<int64_t>(std::floor(y));
  const auto blend_y = static_cast<float>(y - static_cast<double>(iy));
  // Nodes of the coarse field along this row, one beyond each end.
  std::array<float, NoiseField::kRowLength> nodes;
  const int count = static_cast<int>(kTileTexels * scale) + 3;
  static_assert(2 * kTileTexels + 3 <= NoiseField::kRowLength, "room for the coarsest level");
  const float* low = field.row(ix, iy);
  const float* high = field.row(ix, iy + 1);
  for (int k = 0; k < count; ++k) {
    nodes[static_cast<size_t>(k)] = low[k] + blend_y * (high[k] - low[k]);
  }
  stretch_row(nodes.data(), static_cast<float>(x0 - static_cast<double>(ix)),
              static_cast<float>(scale), &patches[static_cast<size_t>(j) * kTileNodes]);
}

const float* TileCanvas::grain_row(int j) const {
  return GroundNoise::shared().grain(key.level).row(key.ix * kTileTexels + noise_shift_x_,
                                                    key.iy * kTileTexels + j + noise_shift_y_);
}

CanvasRow canvas_row(TileCanvas& canvas, int j, int i) {
  const size_t at = static_cast<size_t>(j) * kTileNodes + static_cast<size_t>(i);
  return {&canvas.red[at],   &canvas.green[at],       &canvas.blue[at],
          &canvas.gloss[at], canvas.grain_row(j) + i, &canvas.patches[at]};
}

void cover_with_material(TileCanvas& canvas, int j, GroundMaterial material, float brightness,
                         const float* coverage) {
  const Material& look = material_of(material);
  if (coverage == nullptr) coverage = full_coverage().data();
  const PhotoRow photo = photo_row(canvas, j, canvas.photos[static_cast<size_t>(material)]);
  fill_row(canvas_row(canvas, j, 0), look, brightness, photo, coverage);
  if (look.slab_m > 0.0) draw_joints(canvas, j, look.slab_m, coverage);
}

void cover_with_paint(TileCanvas& canvas, int j, const Rgb& albedo, float wear,
                      const float* coverage) {
  if (coverage == nullptr) coverage = full_coverage().data();
  paint_row(canvas_row(canvas, j, 0), albedo, wear, coverage);
}

void shade_row(TileCanvas& canvas, int j, float light, const float* coverage) {
  if (coverage == nullptr) coverage = full_coverage().data();
  const CanvasRow row = canvas_row(canvas, j, 0);
  for (int i = 0; i < kTileNodes; ++i) {
    const float keep = 1.0F - (1.0F - light) * coverage[i];
    row.red[i] *= keep;
    row.green[i] *= keep;
    row.blue[i] *= keep;
  }
}

void darken_road(TileCanvas& canvas, int j, float factor, const float* coverage) {
  if (coverage == nullptr) coverage = full_coverage().data();
  const CanvasRow row = canvas_row(canvas, j, 0);
  for (int i = 0; i < kTileNodes; ++i) {
    const float keep = 1.0F - (1.0F - factor) * coverage[i] * sealed_road(row.gloss[i]);
    row.red[i] *= keep;
    row.green[i] *= keep;
    row.blue[i] *= keep;
  }
}

}  // namespace bevloc::sim
