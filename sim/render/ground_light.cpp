#include "sim/render/ground_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/world/path.h"

namespace bevloc::sim {
namespace {

constexpr double kLowestCasterM = 0.4;  ///< lower walls (kerbs) cast no visible shadow
constexpr double kLampHeightM = 5.0;    ///< poles at least this high carry a lamp
constexpr size_t kCells = static_cast<size_t>(GroundLight::kSide) * GroundLight::kSide;

struct Corners {
  std::array<Eigen::Vector2d, 4> points;
};

Corners corners_of(const VehicleBody& body, double margin_m) {
  const Se2 map_from_body = body.map_from_body();
  const double x = 0.5 * body.length_m + margin_m;
  const double y = 0.5 * body.width_m + margin_m;
  return {{map_from_body * Eigen::Vector2d(-x, -y), map_from_body * Eigen::Vector2d(x, -y),
           map_from_body * Eigen::Vector2d(x, y), map_from_body * Eigen::Vector2d(-x, y)}};
}

/// Applies a [1 2 1] / 4 filter along rows (step 1) or columns (step kSide).
void soften(std::vector<float>& plane, std::vector<float>& scratch, size_t step) {
  for (size_t i = step; i + step < kCells; ++i) {
    scratch[i] = 0.25F * (plane[i - step] + 2.0F * plane[i] + plane[i + step]);
  }
  std::copy(scratch.begin() + static_cast<std::ptrdiff_t>(step),
            scratch.end() - static_cast<std::ptrdiff_t>(step),
            plane.begin() + static_cast<std::ptrdiff_t>(step));
}

}  // namespace

GroundLight::GroundLight()
    : sun_(kCells, 1.0F),
      sky_(kCells, 1.0F),
      lamps_(kCells, 0.0F),
      scratch_(kCells),
      cells_(kCells) {}

void GroundLight::build(const Eigen::Vector2d& centre, const Surroundings& surroundings,
                        const Lighting& lighting) {
  // Align to whole cells, so that shadows do not flicker while the vehicle moves.
  origin_ = ((centre / kCellM).array().round() - kSide / 2) * kCellM;
  if (lighting.casts_shadows()) {
    cast_shadows(surroundings, lighting);
  } else {
    std::fill(sun_.begin(), sun_.end(), 1.0F);
  }
  mask_.clear();
  for (const VehicleBody& body : surroundings.parked) add_footprint(body, 0.1);
  for (const VehicleBody& body : surroundings.traffic) add_footprint(body, 0.1);
  for (const WallPiece* piece : surroundings.walls) {
    if (piece->wall->top_m >= kLowestCasterM) add_foot(*piece);
  }
  take_mask(0.7F, sky_);
  light_lamps(surroundings, lighting);
  pack();
}

void GroundLight::cast_shadows(const Surroundings& surroundings, const Lighting& lighting) {
  const Eigen::Vector3d to_sun = lighting.to_sun.cast<double>();
  const Eigen::Vector2d shift_per_m = -to_sun.head<2>() / std::max(to_sun.z(), 0.06);
  mask_.clear();
  for (const WallPiece* piece : surroundings.walls) {
    const Wall& wall = *piece->wall;
    if (wall.top_m < kLowestCasterM) continue;
    add_quad(piece->from, piece->to, wall.bottom_m * shift_per_m, wall.top_m * shift_per_m);
  }
  for (const Post* post : surroundings.posts) {
    const Eigen::Vector2d across = post->radius_m * left_of(to_sun.head<2>()).normalized();
    add_quad(post->position - across, post->position + across, post->bottom_m * shift_per_m,
             post->top_m * shift_per_m);
  }
  for (const VehicleBody& body : surroundings.parked) cast_body_shadow(body, shift_per_m);
  for (const VehicleBody& body : surroundings.traffic) cast_body_shadow(body, shift_per_m);
  take_mask(1.0F, sun_);
}

void GroundLight::cast_body_shadow(const VehicleBody& body, const Eigen::Vector2d& shift_per_m) {
  const Corners base = corners_of(body, 0.0);
  for (size_t i = 0; i < 4; ++i) {
    add_quad(base.points[i], base.points[(i + 1) % 4], Eigen::Vector2d::Zero(),
             0.9 * body.height_m * shift_per_m);
  }
  add_footprint(body, 0.0);
}

void GroundLight::add_quad(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                           const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const std::array<Eigen::Vector2f, 4> ring = {cell(a + from), cell(b + from), cell(b + to),
                                               cell(a + to)};
  mask_.add(ring);
}

void GroundLight::add_footprint(const VehicleBody& body, double margin_m) {
  const Corners corners = corners_of(body, margin_m);
  const std::array<Eigen::Vector2f, 4> ring = {cell(corners.points[0]), cell(corners.points[1]),
                                               cell(corners.points[2]), cell(corners.points[3])};
  mask_.add(ring);
}

void GroundLight::add_foot(const WallPiece& piece) {
  constexpr double kReachM = 0.3;
  const Eigen::Vector2d aside = kReachM * left_of((piece.to - piece.from).normalized());
  add_quad(piece.from, piece.to, -aside, aside);
}

void GroundLight::take_mask(float strength, std::vector<float>& plane) {
  for (int j = 0; j < kSide; ++j) {
    float* row = &plane[static_cast<size_t>(j) * kSide];
    switch (mask_.row(j, row)) {
      case CoverageMask::RowKind::kEmpty:
        std::fill_n(row, kSide, 0.0F);
        break;
      case CoverageMask::RowKind::kFull:
        std::fill_n(row, kSide, 1.0F);
        break;
      case CoverageMask::RowKind::kMixed:
        break;
    }
    for (int i = 0; i < kSide; ++i) row[i] = 1.0F - strength * row[i];
  }
  soften(plane, scratch_, 1);
  soften(plane, scratch_, kSide);
}

void GroundLight::light_lamps(const Surroundings& surroundings, const Lighting& lighting) {
  std::fill(lamps_.begin(), lamps_.end(), 0.0F);
  if (lighting.lamps <= 0.0F) return;
  constexpr int kReach = 36;
  for (const Post* post : surroundings.posts) {
    if (post->kind != PostKind::kPole || post->top_m < kLampHeightM) continue;
    const Eigen::Vector2f at = cell(post->position);
    const auto height = static_cast<float>(post->top_m / kCellM);
    const int x0 = std::max(0, static_cast<int>(at.x()) - kReach);
    const int x1 = std::min(kSide - 1, static_cast<int>(at.x()) + kReach);
    const int y0 = std::max(0, static_cast<int>(at.y()) - kReach);
    const int y1 = std::min(kSide - 1, static_cast<int>(at.y()) + kReach);
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const float dx = static_cast<float>(x) - at.x();
        const float dy = static_cast<float>(y) - at.y();
        const float share = height * height / (height * height + dx * dx + dy * dy);
        const float edge = std::max(0.0F, 1.0F - (dx * dx + dy * dy) / (kReach * kReach));
        lamps_[static_cast<size_t>(y) * kSide + x] += 0.6F * share * share * edge;
      }
    }
  }
}

void GroundLight::pack() {
  const auto byte = [](float value) {
    return static_cast<uint32_t>(255.0F * std::clamp(value, 0.0F, 1.0F) + 0.5F);
  };
  for (size_t i = 0; i < kCells; ++i) {
    cells_[i] = byte(sun_[i]) | byte(sky_[i]) << 8U | byte(lamps_[i]) << 16U;
  }
  // Lookups beyond the square repeat its rim, so the rim is set to unshaded.
  constexpr uint32_t kOpen = 0x0000FFFF;
  for (size_t i = 0; i < kSide; ++i) {
    cells_[i] = cells_[kCells - 1 - i] = cells_[i * kSide] = cells_[i * kSide + kSide - 1] = kOpen;
  }
}

}  // namespace bevloc::sim
