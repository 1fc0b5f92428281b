#include "sim/render/ground_painter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/plane.h"
#include "common/target_clones.h"

namespace bevloc::sim {
namespace {

/// Larger texels are too coarse to show tracks or cracks.
constexpr double kCoarsestForTracksM = 0.4;
constexpr double kCoarsestForCracksM = 0.1;

Box box_of(const std::vector<Eigen::Vector2d>& points) {
  Box box;
  for (const Eigen::Vector2d& point : points) box.extend(point);
  return box;
}

Box box_of(const StrokeSegment& segment, double width_m) {
  Box box(segment.from.cwiseMin(segment.to), segment.from.cwiseMax(segment.to));
  box.min().array() -= 0.5 * width_m;
  box.max().array() += 0.5 * width_m;
  return box;
}

/// Whether the ring covers the whole area. May return false for some rings that do.
bool covers(const Ring& ring, const Box& area) {
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    if (area.intersects(Box(a.cwiseMin(b), a.cwiseMax(b)))) return false;
  }
  return is_in_ring(area.center(), ring);
}

/// Packs the planes into texels.
BEVLOC_TARGET_CLONES
void store_texels(const float* red, const float* green, const float* blue, const float* gloss,
                  GroundTexel* texels) {
  const auto byte = [](float value) {
    return static_cast<uint32_t>(std::min(value * 255.0F + 0.5F, 255.0F));
  };
  for (int i = 0; i < kTileArea; ++i) {
    texels[i] =
        byte(std::sqrt(std::max(red[i], 0.0F))) | byte(std::sqrt(std::max(green[i], 0.0F))) << 8U |
        byte(std::sqrt(std::max(blue[i], 0.0F))) << 16U | byte(std::max(gloss[i], 0.0F)) << 24U;
  }
}

}  // namespace

GroundPainter::GroundPainter(const World& world) : world_(world), ageing_(age_roads(world)) {
  index_surfaces();
  index_paint();
  index_ageing();
  if (world.photos == nullptr) return;
  for (size_t material = 0; material < kGroundMaterials; ++material) {
    canvas_.photos[material] =
        world.photos->ground(static_cast<GroundMaterial>(material), world.seed);
  }
}

void GroundPainter::index_surfaces() {
  std::vector<Box> boxes;
  for (const Surface& surface : world_.surfaces) boxes.push_back(box_of(surface.ring));
  surface_index_ = CellIndex(boxes);
}

void GroundPainter::index_paint() {
  std::vector<Box> boxes;
  for (size_t line = 0; line < world_.paint_lines.size(); ++line) {
    append_segments(world_.paint_lines[line].points, static_cast<int>(line), paint_segments_);
  }
  for (const StrokeSegment& segment : paint_segments_) {
    boxes.push_back(box_of(segment, world_.paint_lines[static_cast<size_t>(segment.line)].width_m));
  }
  paint_index_ = CellIndex(boxes);
  boxes.clear();
  for (const PaintArea& area : world_.paint_areas) boxes.push_back(box_of(area.ring));
  area_index_ = CellIndex(boxes);
  boxes.clear();
  for (const Shade& shade : world_.shades) boxes.push_back(box_of(shade.ring));
  shade_index_ = CellIndex(boxes);
}

void GroundPainter::index_ageing() {
  const auto index_of = [this](const std::vector<StrokeSegment>& segments) {
    std::vector<Box> boxes;
    for (const StrokeSegment& segment : segments) {
      boxes.push_back(box_of(segment, ageing_.soilings[static_cast<size_t>(segment.line)].width_m));
    }
    return CellIndex(boxes);
  };
  track_index_ = index_of(ageing_.tracks);
  crack_index_ = index_of(ageing_.cracks);
  std::vector<Box> boxes;
  for (const RoadPatch& patch : ageing_.patches) boxes.push_back(box_of(patch.ring));
  patch_index_ = CellIndex(boxes);
}

void GroundPainter::paint(const TileKey& key, GroundTexel* texels) {
  canvas_.begin(key, world_.seed);
  const double size_m = tile_size_m(key.level);
  const Eigen::Vector2d low(canvas_.origin_x_m(), canvas_.origin_y_m());
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(canvas_.texel_m());
  const Box area(low - margin, low + Eigen::Vector2d::Constant(size_m) + margin);
  paint_surfaces(area);
  paint_ageing(area);
  paint_markings(area);
  paint_shades(area);
  store(texels);
}

void GroundPainter::paint_surfaces(const Box& area) {
  found_.clear();
  surface_index_.query(area, found_);
  // A surface that covers the whole tile hides everything below it.
  const auto top = std::find_if(found_.rbegin(), found_.rend(), [&](int item) {
    return covers(world_.surfaces[static_cast<size_t>(item)].ring, area);
  });
  if (top == found_.rend()) {
    for (int j = 0; j < kTileNodes; ++j) {
      cover_with_material(canvas_, j, world_.background, 1.0F, nullptr);
    }
  }
  for (auto item = top == found_.rend() ? found_.begin() : top.base() - 1; item != found_.end();
       ++item) {
    const Surface& surface = world_.surfaces[static_cast<size_t>(*item)];
    for_each_covered_row(surface.ring, [&](int j, const float* coverage) {
      cover_with_material(canvas_, j, surface.material, surface.brightness, coverage);
    });
  }
}

void GroundPainter::paint_ageing(const Box& area) {
  found_.clear();
  patch_index_.query(area, found_);
  for (const int item : found_) {
    const RoadPatch& patch = ageing_.patches[static_cast<size_t>(item)];
    for_each_covered_row(patch.ring, [&](int j, const float* coverage) {
      darken_road(canvas_, j, patch.shade, coverage);
    });
  }
  if (canvas_.texel_m() <= kCoarsestForTracksM) soil(track_index_, ageing_.tracks, area);
  if (canvas_.texel_m() <= kCoarsestForCracksM) soil(crack_index_, ageing_.cracks, area);
}

void GroundPainter::soil(const CellIndex& index, const std::vector<StrokeSegment>& segments,
                         const Box& area) {
  found_.clear();
  index.query(area, found_);
  for (const int item : found_) {
    const StrokeSegment& segment = segments[static_cast<size_t>(item)];
    draw_soiling(canvas_, segment, ageing_.soilings[static_cast<size_t>(segment.line)]);
  }
}

void GroundPainter::paint_markings(const Box& area) {
  found_.clear();
  paint_index_.query(area, found_);
  for (const int item : found_) {
    const StrokeSegment& segment = paint_segments_[static_cast<size_t>(item)];
    draw_paint(canvas_, segment, world_.paint_lines[static_cast<size_t>(segment.line)]);
  }
  found_.clear();
  area_index_.query(area, found_);
  for (const int item : found_) {
    const PaintArea& paint = world_.paint_areas[static_cast<size_t>(item)];
    for_each_covered_row(paint.ring, [&](int j, const float* coverage) {
      cover_with_paint(canvas_, j, paint.albedo, paint.wear, coverage);
    });
  }
}

void GroundPainter::paint_shades(const Box& area) {
  found_.clear();
  shade_index_.query(area, found_);
  for (const int item : found_) {
    const Shade& shade = world_.shades[static_cast<size_t>(item)];
    for_each_covered_row(shade.ring, [&](int j, const float* coverage) {
      shade_row(canvas_, j, shade.light, coverage);
    });
  }
}

template <typename Row>
void GroundPainter::for_each_covered_row(const Ring& ring, Row row) {
  ring_texels_.clear();
  for (const Eigen::Vector2d& corner : ring) ring_texels_.push_back(canvas_.texel(corner));
  mask_.clear();
  mask_.add(ring_texels_);
  std::array<float, kTileNodes> coverage;
  for (int j = 0; j < kTileNodes; ++j) {
    switch (mask_.row(j, coverage.data())) {
      case CoverageMask::RowKind::kEmpty:
        break;
      case CoverageMask::RowKind::kFull:
        row(j, nullptr);
        break;
      case CoverageMask::RowKind::kMixed:
        row(j, coverage.data());
        break;
    }
  }
}

void GroundPainter::store(GroundTexel* texels) const {
  store_texels(canvas_.red.data(), canvas_.green.data(), canvas_.blue.data(), canvas_.gloss.data(),
               texels);
}

}  // namespace bevloc::sim
