// The distance of cells from a line segment. It is inline, because it is the inner loop of drawing.
#pragma once

#include <algorithm>
#include <cmath>

namespace bevloc {

/// A segment in cells: whole columns and rows are the centres of cells. Its ends may coincide.
class CellSegment {
 public:
  CellSegment(float from_col, float from_row, float d_col, float d_row)
      : from_col_(from_col), from_row_(from_row), d_col_(d_col), d_row_(d_row) {
    const float length_squared = d_col * d_col + d_row * d_row;
    per_length_squared_ = length_squared > 0.0F ? 1.0F / length_squared : 0.0F;
  }

  struct Nearest {
    float along;     ///< where the nearest point lies: 0 at the start of the segment, 1 at its end
    float distance;  ///< distance to that point in cells
  };

  /// The point of the segment that is nearest to a cell.
  Nearest nearest(int col, int row) const {
    const float to_col = static_cast<float>(col) - from_col_;
    const float to_row = static_cast<float>(row) - from_row_;
    const float along =
        std::min(std::max((to_col * d_col_ + to_row * d_row_) * per_length_squared_, 0.0F), 1.0F);
    const float off_col = to_col - along * d_col_;
    const float off_row = to_row - along * d_row_;
    return {along, std::sqrt(off_col * off_col + off_row * off_row)};
  }

 private:
  float from_col_;
  float from_row_;
  float d_col_;
  float d_row_;
  float per_length_squared_;
};

}  // namespace bevloc
