#include "pipeline/solver/gradient_sums.h"

#include "common/target_clones.h"

namespace bevloc {
namespace {

/// Sums of products of the map's gradient (first letter) with the moved features' gradient (second
/// letter) or with the residual. The lever_ sums are weighted by the lever: the distance that a
/// rotation moves the cell along x, in metres per radian.
struct Products {
  float xx, xy, yx, yy, x_residual, y_residual;
  float lever_xx, lever_xy, lever_yx, lever_x_residual;
  float lever2_xx;
};

BEVLOC_TARGET_CLONES Products sum_products(const GradientRow& row) {
  const CellRows& rows = row.rows;
  Lanes xx = {}, xy = {}, yx = {}, yy = {}, x_residual = {}, y_residual = {};
  Lanes lever_xx = {}, lever_xy = {}, lever_yx = {}, lever_x_residual = {}, lever2_xx = {};
  const auto first_lever = static_cast<float>(-row.first_y_m);
  const auto lever_step = static_cast<float>(row.cell_m);
  for (int i = 0; i < row.cells; ++i) {
    const float lever = first_lever + static_cast<float>(i) * lever_step;
    for (int k = 0; k < rows.lanes; k += kLanes) {
      const float* m = rows.map + i * rows.lanes + k;
      const float* b = rows.moved + i * rows.lanes + k;
      const Slope map = slope_at(m, rows.map_row_stride, rows.lanes);
      const Slope bev = slope_at(b, rows.moved_row_stride, rows.lanes);
      const Lanes residual = lanes(m) - lanes(b);
      const Lanes product_xx = map.x * bev.x;
      const Lanes lever_map_x = lever * map.x;
      xx += product_xx;
      xy += map.x * bev.y;
      yx += map.y * bev.x;
      yy += map.y * bev.y;
      x_residual += map.x * residual;
      y_residual += map.y * residual;
      lever_xx += lever * product_xx;
      lever_xy += lever_map_x * bev.y;
      lever_yx += lever * (map.y * bev.x);
      lever_x_residual += lever_map_x * residual;
      lever2_xx += lever * (lever * product_xx);
    }
  }
  return {sum_of(xx),         sum_of(xy),
          sum_of(yx),         sum_of(yy),
          sum_of(x_residual), sum_of(y_residual),
          sum_of(lever_xx),   sum_of(lever_xy),
          sum_of(lever_yx),   sum_of(lever_x_residual),
          sum_of(lever2_xx)};
}

}  // namespace

GradientSums sum_gradients(const GradientRow& row) {
  const Products s = sum_products(row);
  // A rotation moves the point (x, y) along (-y, x): by the lever along x, by x_m along y.
  const double x_m = row.x_m;
  GradientSums sums;
  sums.curvature << s.xx, s.xy, s.lever_xx + x_m * s.xy,  //
      s.yx, s.yy, s.lever_yx + x_m * s.yy,                //
      s.lever_xx + x_m * s.yx, s.lever_xy + x_m * s.yy,
      s.lever2_xx + x_m * (s.lever_xy + s.lever_yx) + x_m * x_m * s.yy;
  sums.slope << s.x_residual, s.y_residual, s.lever_x_residual + x_m * s.y_residual;
  const double per_m = 1.0 / (2.0 * row.cell_m);  // central differences span two cells
  sums.curvature *= per_m * per_m;
  sums.slope *= per_m;
  return sums;
}

}  // namespace bevloc
