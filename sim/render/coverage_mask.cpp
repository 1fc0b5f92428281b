#include "sim/render/coverage_mask.h"

#include <algorithm>
#include <cmath>

namespace bevloc::sim {

CoverageMask::CoverageMask(int width, int height)
    : width_(width),
      height_(height),
      deltas_(static_cast<size_t>(width + 2) * height, 0.0F),
      rows_(static_cast<size_t>(height)) {}

void CoverageMask::clear() {
  for (int j = 0; j < height_; ++j) {
    RowState& state = rows_[static_cast<size_t>(j)];
    if (state.has_edges()) {
      float* deltas = &deltas_[static_cast<size_t>(j) * (width_ + 2)];
      std::fill(deltas + state.first, deltas + state.last + 1, 0.0F);
    }
    state = {};
  }
}

void CoverageMask::add(std::span<const Eigen::Vector2f> ring) {
  float doubled_area = 0.0F;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2f& a = ring[i];
    const Eigen::Vector2f& b = ring[(i + 1) % ring.size()];
    doubled_area += (a.x() - ring[0].x()) * (b.y() - ring[0].y()) -
                    (b.x() - ring[0].x()) * (a.y() - ring[0].y());
  }
  const float sign = doubled_area < 0.0F ? 1.0F : -1.0F;
  for (size_t i = 0; i < ring.size(); ++i) {
    add_edge(ring[i], ring[(i + 1) % ring.size()], sign);
  }
}

void CoverageMask::add_edge(Eigen::Vector2f from, Eigen::Vector2f to, float sign) {
  from.array() += 0.5F;
  to.array() += 0.5F;
  if (from.y() > to.y()) {
    std::swap(from, to);
    sign = -sign;
  }
  const float height = to.y() - from.y();
  const float y_begin = std::max(from.y(), 0.0F);
  const float y_end = std::min(to.y(), static_cast<float>(height_));
  if (!(y_begin < y_end) || std::min(from.x(), to.x()) >= static_cast<float>(width_)) return;
  const float slope = (to.x() - from.x()) / height;
  const int j_end = std::min(height_, static_cast<int>(std::ceil(y_end)));
  for (int j = static_cast<int>(y_begin); j < j_end; ++j) {
    const float top = std::max(y_begin, static_cast<float>(j));
    const float bottom = std::min(y_end, static_cast<float>(j + 1));
    deposit(j, from.x() + (top - from.y()) * slope, from.x() + (bottom - from.y()) * slope,
            sign * (bottom - top));
  }
}

/// Distributes `area` (the height of the edge within row j) over the cells between x_from and x_to.
void CoverageMask::deposit(int j, float x_from, float x_to, float area) {
  const float limit = static_cast<float>(width_);
  const float left = std::clamp(std::min(x_from, x_to), 0.0F, limit);
  const float right = std::clamp(std::max(x_from, x_to), 0.0F, limit);
  RowState& state = rows_[static_cast<size_t>(j)];
  if (right <= 0.0F) {
    state.offset += area;
    return;
  }
  if (left >= limit) return;
  float* deltas = &deltas_[static_cast<size_t>(j) * (width_ + 2)];
  const int first = static_cast<int>(left);
  const int last = static_cast<int>(right);
  state.first = state.has_edges() ? std::min(state.first, first) : first;
  state.last = std::max(state.last, last + 1);
  if (first == last) {
    const float inside = 1.0F - 0.5F * (left + right - 2.0F * static_cast<float>(first));
    deltas[first] += area * inside;
    deltas[first + 1] += area * (1.0F - inside);
    return;
  }
  const float per_cell = area / (right - left);
  float covered = 0.0F;  // sum of the shares up to the current cell
  float carried = 0.0F;  // sum of the deltas written so far
  for (int i = first; i <= last; ++i) {
    const float begin = std::max(left, static_cast<float>(i));
    const float end = std::min(right, static_cast<float>(i + 1));
    const float share = per_cell * (end - begin);
    const float inside = 1.0F - 0.5F * (begin + end - 2.0F * static_cast<float>(i));
    const float total = covered + share * inside;
    deltas[i] += total - carried;
    carried = total;
    covered += share;
  }
  deltas[last + 1] += covered - carried;
}

CoverageMask::RowKind CoverageMask::row(int j, float* coverage) const {
  constexpr float kTiny = 1e-3F;
  const RowState& state = rows_[static_cast<size_t>(j)];
  if (!state.has_edges() && state.offset < kTiny) return RowKind::kEmpty;
  if (!state.has_edges() && state.offset > 1.0F - kTiny) return RowKind::kFull;
  const float* deltas = &deltas_[static_cast<size_t>(j) * (width_ + 2)];
  float sum = state.offset;
  std::fill_n(coverage, state.first, std::clamp(sum, 0.0F, 1.0F));
  const int end = std::min(state.last + 1, width_);
  for (int i = state.first; i < end; ++i) {
    sum += deltas[i];
    coverage[i] = std::clamp(sum, 0.0F, 1.0F);
  }
  std::fill(coverage + end, coverage + width_, std::clamp(sum, 0.0F, 1.0F));
  return RowKind::kMixed;
}

}  // namespace bevloc::sim
