#include "sim/render/panel_bounds.h"

#include <algorithm>
#include <cmath>

namespace bevloc::sim {
namespace {

/// A polygon with four corners, and up to one more for each of the five cuts.
struct Polygon {
  std::array<Eigen::Vector3f, 9> points;
  int size = 0;
};

/// Keeps the part of the polygon where inside(point) >= 0.
template <typename Inside>
bool cut(Polygon& polygon, Inside inside) {
  Polygon kept;
  for (int i = 0; i < polygon.size; ++i) {
    const Eigen::Vector3f& a = polygon.points[static_cast<size_t>(i)];
    const Eigen::Vector3f& b = polygon.points[static_cast<size_t>((i + 1) % polygon.size)];
    const float side_a = inside(a);
    const float side_b = inside(b);
    if (side_a >= 0.0F) kept.points[static_cast<size_t>(kept.size++)] = a;
    if ((side_a >= 0.0F) != (side_b >= 0.0F)) {
      kept.points[static_cast<size_t>(kept.size++)] = a + (b - a) * (side_a / (side_a - side_b));
    }
  }
  polygon = kept;
  return polygon.size > 0;
}

/// Cuts the polygon to the camera's field of view. Returns whether anything is left.
bool cut_to_view(Polygon& polygon, const CameraRays& rays) {
  constexpr float kNearestM = 0.05F;
  // Slightly wider than the view, so that nothing visible is cut off.
  const Eigen::Vector2f margin = 0.02F * (rays.high() - rays.low());
  const Eigen::Vector2f low = rays.low() - margin;
  const Eigen::Vector2f high = rays.high() + margin;
  using Point = Eigen::Vector3f;
  return cut(polygon, [](const Point& p) { return p.z() - kNearestM; }) &&
         cut(polygon, [&](const Point& p) { return p.x() - low.x() * p.z(); }) &&
         cut(polygon, [&](const Point& p) { return high.x() * p.z() - p.x(); }) &&
         cut(polygon, [&](const Point& p) { return p.y() - low.y() * p.z(); }) &&
         cut(polygon, [&](const Point& p) { return high.y() * p.z() - p.y(); });
}

/// Lens distortion bends straight edges. This number of pieces follows the bend to within one
/// pixel.
int pieces_per_edge(const Intrinsics& camera) {
  return camera.is_straight() ? 1 : camera.lens == Lens::kPinhole ? 4 : 12;
}

}  // namespace

std::optional<PixelBox> pixels_of(const std::array<Eigen::Vector3f, 4>& corners_camera,
                                  const CameraRays& rays) {
  Polygon polygon;
  std::copy(corners_camera.begin(), corners_camera.end(), polygon.points.begin());
  polygon.size = 4;
  if (!cut_to_view(polygon, rays)) return std::nullopt;

  const Intrinsics& camera = rays.intrinsics();
  const int pieces = pieces_per_edge(camera);
  Eigen::Vector2d low(camera.width_px, camera.height_px);
  Eigen::Vector2d high(-1.0, -1.0);
  for (int i = 0; i < polygon.size; ++i) {
    const Eigen::Vector3d a = polygon.points[static_cast<size_t>(i)].cast<double>();
    const Eigen::Vector3d b =
        polygon.points[static_cast<size_t>((i + 1) % polygon.size)].cast<double>();
    for (int piece = 0; piece < pieces; ++piece) {
      const auto pixel = camera.project(a + (b - a) * (static_cast<double>(piece) / pieces));
      // The point is outside the range of the lens model, so take the whole image.
      if (!pixel) return PixelBox{0, 0, camera.width_px - 1, camera.height_px - 1};
      low = low.cwiseMin(*pixel);
      high = high.cwiseMax(*pixel);
    }
  }
  constexpr double kMarginPx = 1.5;
  PixelBox box{};
  box.left = static_cast<int>(std::max(0.0, low.x() - kMarginPx));
  box.top = static_cast<int>(std::max(0.0, low.y() - kMarginPx));
  box.right = static_cast<int>(std::min(camera.width_px - 1.0, std::ceil(high.x() + kMarginPx)));
  box.bottom = static_cast<int>(std::min(camera.height_px - 1.0, std::ceil(high.y() + kMarginPx)));
  if (box.left > box.right || box.top > box.bottom) return std::nullopt;
  return box;
}

}  // namespace bevloc::sim
