#include "sim/render/cell_index.h"

#include <algorithm>

namespace bevloc::sim {
namespace {

constexpr double kSmallestCellM = 12.8;
constexpr double kMostCellsAcross = 256.0;

}  // namespace

CellIndex::CellIndex(const std::vector<Box>& boxes) : boxes_(boxes) {
  for (const Box& box : boxes_) bounds_.extend(box);
  if (boxes_.empty()) return;
  cell_size_m_ = std::max(kSmallestCellM, bounds_.sizes().maxCoeff() / kMostCellsAcross);
  columns_ = static_cast<int>(bounds_.sizes().x() / cell_size_m_) + 1;
  rows_ = static_cast<int>(bounds_.sizes().y() / cell_size_m_) + 1;
  cells_.resize(static_cast<size_t>(columns_) * rows_);
  for (size_t item = 0; item < boxes_.size(); ++item) {
    const Eigen::Vector2i low = cell_of(boxes_[item].min());
    const Eigen::Vector2i high = cell_of(boxes_[item].max());
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        cells_[static_cast<size_t>(y) * columns_ + x].push_back(static_cast<int>(item));
      }
    }
  }
}

Eigen::Vector2i CellIndex::cell_of(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d cell = (point - bounds_.min()) / cell_size_m_;
  return {static_cast<int>(std::clamp(cell.x(), 0.0, columns_ - 1.0)),
          static_cast<int>(std::clamp(cell.y(), 0.0, rows_ - 1.0))};
}

void CellIndex::query(const Box& area, std::vector<int>& items) const {
  if (boxes_.empty() || !bounds_.intersects(area)) return;
  const auto start = static_cast<std::ptrdiff_t>(items.size());
  const Eigen::Vector2i low = cell_of(area.min());
  const Eigen::Vector2i high = cell_of(area.max());
  for (int y = low.y(); y <= high.y(); ++y) {
    for (int x = low.x(); x <= high.x(); ++x) {
      for (const int item : cells_[static_cast<size_t>(y) * columns_ + x]) {
        if (boxes_[static_cast<size_t>(item)].intersects(area)) items.push_back(item);
      }
    }
  }
  std::sort(items.begin() + start, items.end());
  items.erase(std::unique(items.begin() + start, items.end()), items.end());
}

}  // namespace bevloc::sim
