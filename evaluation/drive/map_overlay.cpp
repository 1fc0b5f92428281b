#include "evaluation/drive/map_overlay.h"

#include <cmath>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "evaluation/drive/drawing.h"

namespace bevloc::evaluation {
namespace {

constexpr double kReach_m = 40.0;
constexpr double kPieceLength_m = 0.5;

/// The pixel of a point on the ground, given in vehicle coordinates. Empty if it is not visible.
std::optional<cv::Point2d> project_ground(const CameraModel& camera, const Se3& camera_from_vehicle,
                                          const Eigen::Vector2d& point_vehicle) {
  const Eigen::Vector3d point =
      camera_from_vehicle * Eigen::Vector3d(point_vehicle.x(), point_vehicle.y(), 0.0);
  if (point.z() < 0.3) return std::nullopt;
  const auto pixel = camera.intrinsics.project(point);
  if (!pixel) return std::nullopt;
  return cv::Point2d(pixel->x(), pixel->y());
}

void draw_segment(const CameraModel& camera, const Se3& camera_from_vehicle,
                  const Eigen::Vector2d& from, const Eigen::Vector2d& to, const cv::Scalar& color,
                  cv::Mat& image) {
  // Short pieces, because lens distortion bends a straight line. Pieces behind the camera are
  // skipped.
  const int pieces = std::max(1, static_cast<int>(std::ceil((to - from).norm() / kPieceLength_m)));
  const cv::Rect2d frame(-200.0, -200.0, image.cols + 400.0, image.rows + 400.0);
  std::optional<cv::Point2d> last;
  for (int i = 0; i <= pieces; ++i) {
    const Eigen::Vector2d point = from + (to - from) * (static_cast<double>(i) / pieces);
    const auto pixel = project_ground(camera, camera_from_vehicle, point);
    if (last && pixel && frame.contains(*last) && frame.contains(*pixel)) {
      cv::line(image, *last, *pixel, color, 2, cv::LINE_AA);
    }
    last = pixel;
  }
}

}  // namespace

void draw_map_over_image(const MapIndex& map, const Se2& map_from_vehicle,
                         const CameraModel& camera, cv::Mat& image) {
  const Eigen::Vector2d reach(kReach_m, kReach_m);
  std::vector<MapIndex::Segment> found;
  map.query(map_from_vehicle.translation() - reach, map_from_vehicle.translation() + reach, found);
  const Se2 vehicle_from_map = map_from_vehicle.inverse();
  const Se3 camera_from_vehicle = camera.vehicle_from_camera.inverse();
  for (const MapIndex::Segment& segment : found) {
    const MapElement& element = map.map().elements[segment.element];
    const size_t next = (segment.first + 1) % element.points.size();
    draw_segment(camera, camera_from_vehicle, vehicle_from_map * element.points[segment.first],
                 vehicle_from_map * element.points[next], class_color(element.element_class),
                 image);
  }
}

}  // namespace bevloc::evaluation
