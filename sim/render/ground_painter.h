// Paints the texture tiles of the ground from the geometry of a world.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "sim/render/cell_index.h"
#include "sim/render/coverage_mask.h"
#include "sim/render/road_ageing.h"
#include "sim/render/stroke.h"
#include "sim/render/tile_canvas.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// The world must outlive the painter. One thread, because it owns its canvas.
class GroundPainter {
 public:
  explicit GroundPainter(const World& world);

  /// Writes the kTileArea texels of a tile, row by row with increasing y.
  void paint(const TileKey& key, GroundTexel* texels);

 private:
  void index_surfaces();
  void index_paint();
  void index_ageing();

  void paint_surfaces(const Box& area);
  void paint_ageing(const Box& area);
  void soil(const CellIndex& index, const std::vector<StrokeSegment>& segments, const Box& area);
  void paint_markings(const Box& area);
  void paint_shades(const Box& area);
  /// Calls row(j, coverage) for each row of the tile that the ring touches. `coverage` is null for
  /// a fully covered row.
  template <typename Row>
  void for_each_covered_row(const Ring& ring, Row row);
  void store(GroundTexel* texels) const;

  const World& world_;
  CellIndex surface_index_;
  std::vector<StrokeSegment> paint_segments_;
  CellIndex paint_index_;
  CellIndex area_index_;
  CellIndex shade_index_;
  RoadAgeing ageing_;
  CellIndex track_index_;
  CellIndex crack_index_;
  CellIndex patch_index_;

  TileCanvas canvas_;
  CoverageMask mask_{kTileNodes, kTileNodes};
  std::vector<Eigen::Vector2f> ring_texels_;
  std::vector<int> found_;
};

}  // namespace bevloc::sim
