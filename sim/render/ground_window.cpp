#include "sim/render/ground_window.h"

#include <cmath>

namespace bevloc::sim {
namespace {

constexpr int kCoarsest = kGroundLevels - 1;

int64_t coarsest_tile_at(double position_m) {
  return static_cast<int64_t>(std::floor(position_m / tile_size_m(kCoarsest)));
}

}  // namespace

GroundWindow::GroundWindow(std::shared_ptr<GroundTiles> tiles) : tiles_(std::move(tiles)) {
  held_.reserve(GroundTiles::kMostHeld);
  directory_.fill(kMissing);
}

void GroundWindow::open(const Eigen::Vector2d& centre) {
  close();
  origin_ix_ = coarsest_tile_at(centre.x());
  origin_iy_ = coarsest_tile_at(centre.y());
}

void GroundWindow::close() {
  for (size_t i = 0; i < held_.size(); ++i) give_back(i);
  held_.clear();
  oldest_ = 0;
}

void GroundWindow::give_back(size_t i) {
  int32_t& entry = directory_[static_cast<size_t>(held_[i])];
  tiles_->give_back(entry);
  entry = kMissing;
}

Eigen::Vector2d GroundWindow::local_origin() const {
  return {static_cast<double>(origin_ix_) * tile_size_m(kCoarsest),
          static_cast<double>(origin_iy_) * tile_size_m(kCoarsest)};
}

void GroundWindow::fetch(int level, int32_t tile_x, int32_t tile_y) {
  const int32_t place = directory_index(level, tile_x, tile_y);
  if (held_.size() < GroundTiles::kMostHeld) {
    held_.push_back(place);
  } else {
    give_back(oldest_);
    held_[oldest_] = place;
    oldest_ = (oldest_ + 1) % held_.size();
  }
  const int64_t scale = int64_t{1} << (kCoarsest - level);
  directory_[static_cast<size_t>(place)] =
      tiles_->borrow({level, tile_x + origin_ix_ * scale, tile_y + origin_iy_ * scale});
}

}  // namespace bevloc::sim
