#include "sim/render/panel_pass.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "common/target_clones.h"
#include "sim/render/bilinear.h"
#include "sim/render/headlight.h"
#include "sim/render/panel_bounds.h"

namespace bevloc::sim {
namespace {

/// A panel in the camera frame. A ray r = (x, y, 1) hits the panel's plane at r / nearness, where
/// nearness = plane . r. The position of that point along the lower edge, in metres, is
/// (along . r) / nearness + along_0; likewise for `up`.
struct PanelInView {
  float plane[3];
  float along[3];
  float up[3];
  float along_0, up_0;
  float length_m, height_m;
  float pixel_angle;
  float facing;  ///< distance d of the plane from the camera: cos(incidence) = nearness * d / |r|
  float lean;    ///< 0 for an upright panel, 1 for a horizontal one (foreshortened upwards)
  float u_per_m, v_per_m, u_start;
  float lowest_v, highest_v;  ///< limits of v; -kNoLimit, kNoLimit if the texture repeats upwards
  const uint32_t* texels;
  Rgb tint;
  Rgb light;
  float glow;
  float headlights;
  float haze_per_m;
  Rgb haze;
  float ahead[3], aside[3];  ///< axes of the vehicle frame
  float ahead_0, aside_0;
};

constexpr float kNoLimit = 1e4F;

/// The intermediate values of up to kRun consecutive pixels of a row.
struct PanelRun {
  alignas(64) float rx[kRun], ry[kRun];
  alignas(64) float nearness[kRun], u[kRun], v[kRun], cover[kRun], footprint[kRun], head[kRun];
  alignas(64) float red[kRun], green[kRun], blue[kRun];
};

inline float dot(const float* a, float x, float y) {
  return a[0] * x + a[1] * y + a[2];
}

/// The share of a pixel (a box of `size` around `at`) that lies within [0, length].
inline float overlap(float at, float length, float size) {
  const float inside = std::min(at, length - at) / size + 0.5F;
  return std::clamp(inside, 0.0F, std::min(1.0F, length / size));
}

/// Intersects the rays with the panel. Returns whether it covers any pixel and is not hidden there.
BEVLOC_TARGET_CLONES
bool intersect(const PanelInView& panel, const float* hidden_by, int count, PanelRun& run) {
  const PanelInView s = panel;
  float most = 0.0F;
  for (int i = 0; i < count; ++i) {
    const float nearness = dot(s.plane, run.rx[i], run.ry[i]);
    const float depth = 1.0F / std::max(nearness, 1e-4F);
    const float along = dot(s.along, run.rx[i], run.ry[i]) * depth + s.along_0;
    const float up = dot(s.up, run.rx[i], run.ry[i]) * depth + s.up_0;
    const float pixel = depth * s.pixel_angle;
    const float length2 = run.rx[i] * run.rx[i] + run.ry[i] * run.ry[i] + 1.0F;
    const float incidence = std::max(0.04F, nearness * s.facing / std::sqrt(length2));
    const float pixel_along = pixel * std::min(12.0F, s.lean > 0.5F ? 1.0F : 1.0F / incidence);
    const float pixel_up = pixel * std::min(12.0F, s.lean > 0.5F ? 1.0F / incidence : 1.0F);
    // The ends are sharp, so that pieces of a wall meet without a seam. Panels narrower than 3
    // pixels have soft ends instead.
    const float ends = along >= 0.0F && along < s.length_m ? 1.0F : 0.0F;
    const float thin = std::min(1.0F, s.length_m / pixel_along);
    const float soft = overlap(along, s.length_m, pixel_along);
    float cover = s.length_m < 3.0F * pixel_along ? soft : ends * thin;
    cover *= overlap(up, s.height_m, pixel_up);
    cover = nearness > 1e-3F && nearness > hidden_by[i] * 1.0001F ? cover : 0.0F;
    most = std::max(most, cover);
    run.nearness[i] = nearness;
    run.cover[i] = cover;
    run.u[i] = along * s.u_per_m + s.u_start;
    run.v[i] = up * s.v_per_m;
    run.footprint[i] = std::sqrt(pixel_along * s.u_per_m * pixel_up * s.v_per_m);
  }
  return most > 0.0F;
}

/// Computes the light of the own vehicle's headlights at the hit points.
BEVLOC_TARGET_CLONES
void add_headlights(const PanelInView& panel, int count, PanelRun& run) {
  const PanelInView s = panel;
  for (int i = 0; i < count; ++i) {
    const float depth = 1.0F / std::max(run.nearness[i], 1e-3F);
    const float ahead = dot(s.ahead, run.rx[i], run.ry[i]) * depth + s.ahead_0;
    const float aside = dot(s.aside, run.rx[i], run.ry[i]) * depth + s.aside_0;
    run.head[i] = s.headlights * 2.0F * headlight_share(ahead, aside);
  }
}

/// Samples and lights the panel's texture. Holes in the texture reduce the cover.
BEVLOC_TARGET_CLONES
void apply_texture(const PanelInView& panel, int count, PanelRun& run) {
  const PanelInView s = panel;
  const float scale = kTextureRange / (255.0F * 255.0F);
  const uint32_t* texels = s.texels;
  const int32_t* mip_offsets = kMipOffsets.data();
  const int32_t* mip_sides = kMipSides.data();
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    const float size_in_texels = run.footprint[i] * kTextureSide;
    const int32_t mip = (size_in_texels > 1.4F) + (size_in_texels > 2.8F) +
                        (size_in_texels > 5.6F) + (size_in_texels > 11.3F) +
                        (size_in_texels > 22.6F) + (size_in_texels > 45.0F);
    const int32_t side = mip_sides[mip];
    const int32_t start = mip_offsets[mip];
    const auto size = static_cast<float>(side);
    const float x = run.u[i] * size - 0.5F;
    const float y =
        std::clamp(run.v[i] * size - 0.5F, s.lowest_v * size, s.highest_v * size - 1.001F);
    const float whole_x = std::floor(x);
    const float whole_y = std::floor(y);
    const int32_t mask = side - 1;
    const int32_t x0 = static_cast<int32_t>(whole_x) & mask;
    const int32_t x1 = (x0 + 1) & mask;
    const int32_t y0 = (static_cast<int32_t>(whole_y) & mask) * side + start;
    const int32_t y1 = ((static_cast<int32_t>(whole_y) + 1) & mask) * side + start;
    const Neighbours near{texels[y0 + x0], texels[y0 + x1], texels[y1 + x0],
                          texels[y1 + x1], x - whole_x,     y - whole_y};
    const float code = near.channel(24) * (2.0F / 255.0F);
    const float own = std::clamp(code - 1.0F, 0.0F, 1.0F);
    const float red = near.channel(0);
    const float green = near.channel(8);
    const float blue = near.channel(16);
    const float shine = s.glow * own * std::clamp(red * red * scale * 4.0F - 1.2F, 0.0F, 1.0F);
    const float through = run.nearness[i] / (run.nearness[i] + s.haze_per_m);
    const auto shade = [&](float root, float tint, float light, float head, float haze) {
      const float albedo = root * root * scale * (tint + own * (1.0F - tint));
      const float lit = albedo * (light + run.head[i] * head + shine);
      return haze + through * (lit - haze);
    };
    run.red[i] = shade(red, s.tint.r, s.light.r, kHeadlightColour.r, s.haze.r);
    run.green[i] = shade(green, s.tint.g, s.light.g, kHeadlightColour.g, s.haze.g);
    run.blue[i] = shade(blue, s.tint.b, s.light.b, kHeadlightColour.b, s.haze.b);
    run.cover[i] *= std::min(code, 1.0F);
  }
}

/// Blends the run into the image.
BEVLOC_TARGET_CLONES
void blend(const PanelRun& run, int count, float* __restrict red, float* __restrict green,
           float* __restrict blue, float* __restrict nearness) {
  for (int i = 0; i < count; ++i) {
    red[i] += run.cover[i] * (run.red[i] - red[i]);
    green[i] += run.cover[i] * (run.green[i] - green[i]);
    blue[i] += run.cover[i] * (run.blue[i] - blue[i]);
    nearness[i] = run.cover[i] > 0.5F ? run.nearness[i] : nearness[i];
  }
}

void store(const Eigen::Vector3f& vector, float* values) {
  Eigen::Map<Eigen::Vector3f>{values} = vector;
}

/// The light on the side that faces the camera.
Rgb light_on(const Panel& panel, const Eigen::Vector3f& normal, const Lighting& lighting) {
  const float towards_sun = std::max(0.0F, normal.dot(lighting.to_sun));
  const float sun = std::lerp(towards_sun, 0.5F, panel.softness);
  const float sky = 0.62F + 0.38F * normal.z();
  return sun * lighting.sun + sky * lighting.ambient + (0.16F * lighting.lamps) * kLampColour;
}

/// Transforms a panel into the camera frame. Returns false if the camera sees it edge-on.
bool view_panel(const Panel& panel, const View& view, const Lighting& lighting, PanelInView& seen) {
  const Eigen::Matrix3f camera_from_map = view.map_from_camera.transpose();
  const Eigen::Vector3f normal = panel.along.cross(panel.up);
  const float distance = normal.dot(panel.corner);
  if (std::abs(distance) < 2e-3F) return false;
  seen.facing = std::abs(distance);
  store(camera_from_map * (normal / distance), seen.plane);
  store(camera_from_map * panel.along, seen.along);
  store(camera_from_map * panel.up, seen.up);
  seen.along_0 = -panel.along.dot(panel.corner);
  seen.up_0 = -panel.up.dot(panel.corner);
  seen.length_m = panel.length_m;
  seen.height_m = panel.height_m;
  seen.pixel_angle = static_cast<float>(1.0 / view.rays->intrinsics().fx_px);
  seen.lean = std::abs(normal.z());
  seen.u_per_m = panel.u_per_m;
  seen.v_per_m = panel.v_per_m;
  seen.u_start = panel.u_start;
  const Texture& texture = panel.texture();
  const bool repeats_v = texture.period_v_m > 0.0F;
  seen.lowest_v = repeats_v ? -kNoLimit : 0.0F;
  seen.highest_v = repeats_v ? kNoLimit : 1.0F;
  seen.texels = texture.texels.data();
  seen.tint = panel.tint;
  // `distance` is positive where the normal points away from the camera.
  seen.light = light_on(panel, distance > 0.0F ? Eigen::Vector3f(-normal) : normal, lighting);
  seen.glow = panel.glows ? lighting.glow : 0.0F;
  seen.haze = lighting.haze;
  seen.haze_per_m = lighting.haze_per_m;
  seen.headlights = lighting.headlights;
  const Eigen::Vector3f forward(view.vehicle_forward.x(), view.vehicle_forward.y(), 0.0F);
  const Eigen::Vector3f left(-forward.y(), forward.x(), 0.0F);
  const Eigen::Vector2f camera = (view.position.head<2>() - view.vehicle).cast<float>();
  store(camera_from_map * forward, seen.ahead);
  store(camera_from_map * left, seen.aside);
  seen.ahead_0 = camera.dot(forward.head<2>());
  seen.aside_0 = camera.dot(left.head<2>());
  return true;
}

void draw_panel(const View& view, const PanelInView& panel, const PixelBox& box,
                LinearImage& image) {
  PanelRun run;
  std::fill_n(run.head, kRun, 0.0F);
  for (int v = box.top; v <= box.bottom; ++v) {
    for (int u = box.left; u <= box.right; u += kRun) {
      const int count = std::min(kRun, box.right - u + 1);
      const size_t at = static_cast<size_t>(v) * static_cast<size_t>(image.width) + u;
      view.rays->get(at, count, run.rx, run.ry);
      if (!intersect(panel, &image.nearness[at], count, run)) continue;
      if (panel.headlights > 0.0F) add_headlights(panel, count, run);
      apply_texture(panel, count, run);
      blend(run, count, &image.red[at], &image.green[at], &image.blue[at], &image.nearness[at]);
    }
  }
}

}  // namespace

void draw_panels(const View& view, const Lighting& lighting, std::span<const Panel> panels,
                 LinearImage& image) {
  const Eigen::Matrix3f camera_from_map = view.map_from_camera.transpose();
  PanelInView seen;
  for (const Panel& panel : panels) {
    const Eigen::Vector3f corner = camera_from_map * panel.corner;
    const Eigen::Vector3f along = camera_from_map * (panel.length_m * panel.along);
    const Eigen::Vector3f up = camera_from_map * (panel.height_m * panel.up);
    const auto box =
        pixels_of({corner, corner + along, corner + along + up, corner + up}, *view.rays);
    if (box && view_panel(panel, view, lighting, seen)) draw_panel(view, seen, *box, image);
  }
}

}  // namespace bevloc::sim
