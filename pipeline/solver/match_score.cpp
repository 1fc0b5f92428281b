#include "pipeline/solver/match_score.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/target_clones.h"
#include "pipeline/solver/cell_rows.h"
#include "pipeline/solver/zncc.h"

namespace bevloc {
namespace {

/// Sums over cells and channels, of the map (m) and of the moved features (b).
struct ScoreProducts {
  double mm = 0.0;
  double mb = 0.0;
  double bb = 0.0;

  ScoreProducts& operator+=(const ScoreProducts& other) {
    mm += other.mm;
    mb += other.mb;
    bb += other.bb;
    return *this;
  }
};

struct LaneProducts {
  Lanes mm = {};
  Lanes mb = {};
  Lanes bb = {};

  void add(const Lanes& m, const Lanes& b) {
    mm += m * m;
    mb += m * b;
    bb += b * b;
  }
  ScoreProducts sum() const { return {sum_of(mm), sum_of(mb), sum_of(bb)}; }
};

struct Sums {
  double map_value = 0.0;
  double moved_value = 0.0;
  ScoreProducts value;
  ScoreProducts gradient[3];  ///< along x, along y, by yaw
};

/// Neighbouring cells of one row of both sides, none at the edge of the grid.
struct CellRow {
  CellRows rows;
  int cells;
  float x_m;        ///< x of the row, relative to the centre of rotation
  float first_y_m;  ///< y of the first cell, likewise
  float cell_m;
};

BEVLOC_TARGET_CLONES void add_row(const CellRow& row, Sums& sums) {
  const CellRows& rows = row.rows;
  Lanes map_value = {};
  Lanes moved_value = {};
  LaneProducts value;
  LaneProducts along_x;
  LaneProducts along_y;
  LaneProducts by_yaw;
  for (int i = 0; i < row.cells; ++i) {
    // A rotation moves the point (x, y) along (-y, x).
    const float lever_m = static_cast<float>(i) * row.cell_m - row.first_y_m;
    for (int k = 0; k < rows.lanes; k += kLanes) {
      const float* m = rows.map + i * rows.lanes + k;
      const float* b = rows.moved + i * rows.lanes + k;
      const Slope map = slope_at(m, rows.map_row_stride, rows.lanes);
      const Slope moved = slope_at(b, rows.moved_row_stride, rows.lanes);
      map_value += lanes(m);
      moved_value += lanes(b);
      value.add(lanes(m), lanes(b));
      along_x.add(map.x, moved.x);
      along_y.add(map.y, moved.y);
      by_yaw.add(lever_m * map.x + row.x_m * map.y, lever_m * moved.x + row.x_m * moved.y);
    }
  }
  sums.map_value += sum_of(map_value);
  sums.moved_value += sum_of(moved_value);
  sums.value += value.sum();
  sums.gradient[0] += along_x.sum();
  sums.gradient[1] += along_y.sum();
  sums.gradient[2] += by_yaw.sum();
}

double cosine(const ScoreProducts& products) {
  const double lengths = std::sqrt(products.mm) * std::sqrt(products.bb);
  return lengths > 0.0 ? std::clamp(products.mb / lengths, 0.0, 1.0) : 0.0;
}

}  // namespace

MatchScore score_match(const CellFeatures& map, const LaneBuffer& moved, const Se2& correction,
                       int border) {
  const BevGrid& grid = map.grid();
  assert(border >= 1 && moved.size() == static_cast<size_t>(grid.cells()) * map.lanes());
  const int cells = grid.cols - 2 * border;
  const int rows = grid.rows - 2 * border;
  if (rows <= 0 || cells <= 0) return {};
  Sums sums;
  for (int row = border; row < border + rows; ++row) {
    add_row({.rows = rows_at(map, moved, row, border),
             .cells = cells,
             .x_m = static_cast<float>(grid.x_of_row(row) - correction.x_m),
             .first_y_m = static_cast<float>(grid.y_of_col(border) - correction.y_m),
             .cell_m = static_cast<float>(grid.cell_m)},
            sums);
  }
  const double count = static_cast<double>(rows) * cells * map.channels();
  const double correlation = zncc(sums.value.mb, moments(sums.map_value, sums.value.mm, count),
                                  moments(sums.moved_value, sums.value.bb, count), count);
  return {std::clamp(correlation, 0.0, 1.0),
          {cosine(sums.gradient[0]), cosine(sums.gradient[1]), cosine(sums.gradient[2])}};
}

}  // namespace bevloc
