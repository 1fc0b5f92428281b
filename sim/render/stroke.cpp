#include "sim/render/stroke.h"

#include <algorithm>
#include <cmath>

#include "common/target_clones.h"
#include "sim/render/paint_wear.h"

namespace bevloc::sim {
namespace {

/// A segment in texels. Node (i, j) lies `across` texels from the axis and `along` texels from its
/// start.
struct StrokeAxis {
  Eigen::Vector2f from;
  Eigen::Vector2f direction;
  float length;

  float along(float i, float j) const {
    return (i - from.x()) * direction.x() + (j - from.y()) * direction.y();
  }
  float across(float i, float j) const {
    return (j - from.y()) * direction.x() - (i - from.x()) * direction.y();
  }
};

StrokeAxis axis_of(const TileCanvas& canvas, const StrokeSegment& segment) {
  const Eigen::Vector2f from = canvas.texel(segment.from);
  const Eigen::Vector2f edge = canvas.texel(segment.to) - from;
  const float length = std::max(edge.norm(), 1e-6F);
  return {from, edge / length, length};
}

/// Narrows [low, high] to the i for which value + slope * i lies within [from, to].
void narrow(float value, float slope, float from, float to, float& low, float& high) {
  if (std::abs(slope) < 1e-6F) {
    if (value < from || value > to) high = low - 1.0F;
    return;
  }
  const float a = (from - value) / slope;
  const float b = (to - value) / slope;
  low = std::max(low, std::min(a, b));
  high = std::min(high, std::max(a, b));
}

/// Calls span(j, first, last) for the nodes of each row within `reach` texels of the segment.
template <typename Span>
void for_each_span(const StrokeAxis& axis, float reach, Span span) {
  const float end_y = axis.from.y() + axis.direction.y() * axis.length;
  const float low_y = std::min(axis.from.y(), end_y) - reach;
  const float high_y = std::max(axis.from.y(), end_y) + reach;
  if (high_y < 0.0F || low_y > kTileTexels) return;
  const int j_begin = static_cast<int>(std::ceil(std::max(low_y, 0.0F)));
  const int j_end = static_cast<int>(std::min(high_y, static_cast<float>(kTileTexels)));
  for (int j = j_begin; j <= j_end; ++j) {
    float low = 0.0F;
    float high = kTileTexels;
    const auto y = static_cast<float>(j);
    narrow(axis.across(0.0F, y), -axis.direction.y(), -reach, reach, low, high);
    narrow(axis.along(0.0F, y), axis.direction.x(), 0.0F, axis.length, low, high);
    const int first = static_cast<int>(std::ceil(low));
    const int last = static_cast<int>(std::floor(high));
    if (first <= last) span(j, first, last);
  }
}

/// The share of a texel (a box at `distance` from a line) that lies within `half` texels of the
/// line.
inline float band_coverage(float distance, float half) {
  return std::clamp(half + 0.5F - std::abs(distance), 0.0F, std::min(1.0F, 2.0F * half));
}

/// The dash pattern of a line, in texels.
struct Dashes {
  float half_dash;
  float period;
  float to_centre;  ///< distance from the start of the segment back to the centre of a dash
  float solid;      ///< 1 for a line without gaps, 0 for dashes

  float coverage(float along) const {
    const float turns = (along + to_centre) / period;
    const float distance = (turns - std::floor(turns + 0.5F)) * period;
    return std::max(solid, band_coverage(distance, half_dash));
  }
};

Dashes dashes_of(const PaintLine& line, double start_m, double texel_m) {
  if (line.dash_m <= 0.0) return {0.0F, 1.0F, 0.0F, 1.0F};
  const double period_m = line.dash_m + std::max(line.gap_m, 0.01);
  const double offset_m = std::remainder(start_m + line.phase_m - 0.5 * line.dash_m, period_m);
  return {static_cast<float>(0.5 * line.dash_m / texel_m), static_cast<float>(period_m / texel_m),
          static_cast<float>(offset_m / texel_m), 0.0F};
}

/// The inputs of paint_span().
struct PaintSpan {
  float across, across_step, along, along_step, half_width, wear;
  Dashes dashes;
  Rgb albedo;
};

BEVLOC_TARGET_CLONES
void paint_span(const CanvasRow& row, const PaintSpan& span, int count) {
  const PaintWear worn(span.wear);
  const PaintSpan s = span;
  float* red = row.red;
  float* green = row.green;
  float* blue = row.blue;
  const float* grain = row.grain;
  const float* patches = row.patches;
#pragma GCC ivdep
  for (int k = 0; k < count; ++k) {
    const auto step = static_cast<float>(k);
    float cover = band_coverage(s.across + step * s.across_step, s.half_width);
    cover *= s.dashes.coverage(s.along + step * s.along_step);
    cover *= worn.kept(grain[k], patches[k]);
    const float shade = worn.shade(grain[k]);
    red[k] += cover * (shade * s.albedo.r - red[k]);
    green[k] += cover * (shade * s.albedo.g - green[k]);
    blue[k] += cover * (shade * s.albedo.b - blue[k]);
  }
}

}  // namespace

void draw_paint(TileCanvas& canvas, const StrokeSegment& segment, const PaintLine& line) {
  const StrokeAxis axis = axis_of(canvas, segment);
  const double texel_m = canvas.texel_m();
  PaintSpan span{};
  span.half_width = static_cast<float>(0.5 * line.width_m / texel_m);
  span.across_step = -axis.direction.y();
  span.along_step = axis.direction.x();
  span.wear = line.wear;
  span.albedo = line.albedo;
  span.dashes = dashes_of(line, segment.start_m, texel_m);
  for_each_span(axis, span.half_width + 0.5F, [&](int j, int first, int last) {
    span.across = axis.across(static_cast<float>(first), static_cast<float>(j));
    span.along = axis.along(static_cast<float>(first), static_cast<float>(j));
    paint_span(canvas_row(canvas, j, first), span, last - first + 1);
  });
}

void draw_soiling(TileCanvas& canvas, const StrokeSegment& segment, const Soiling& soiling) {
  const StrokeAxis axis = axis_of(canvas, segment);
  const float half = static_cast<float>(0.5 * soiling.width_m / canvas.texel_m());
  // A stripe thinner than a texel darkens the texel in proportion to its width.
  const float strength = soiling.strength * std::min(1.0F, 2.0F * half);
  const float inverse_reach = 1.0F / std::max(half, 0.75F);
  for_each_span(axis, std::max(half, 0.75F), [&](int j, int first, int last) {
    const CanvasRow row = canvas_row(canvas, j, first);
    const float start = axis.across(static_cast<float>(first), static_cast<float>(j));
    for (int k = 0; k <= last - first; ++k) {
      const float across = (start - static_cast<float>(k) * axis.direction.y()) * inverse_reach;
      const float profile = std::max(0.0F, 1.0F - across * across);
      const float keep = 1.0F - strength * profile * sealed_road(row.gloss[k]);
      row.red[k] *= keep;
      row.green[k] *= keep;
      row.blue[k] *= keep;
    }
  });
}

void append_segments(const Polyline& points, int line, std::vector<StrokeSegment>& segments) {
  double start_m = 0.0;
  for (size_t i = 1; i < points.size(); ++i) {
    segments.push_back({points[i - 1], points[i], start_m, line});
    start_m += (points[i] - points[i - 1]).norm();
  }
}

}  // namespace bevloc::sim
