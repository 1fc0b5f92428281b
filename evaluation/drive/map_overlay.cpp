#include "evaluation/drive/map_overlay.h"

#include <opencv2/imgproc.hpp>

#include "evaluation/drive/drawing.h"
#include "pipeline/localization/projected_map.h"

namespace bevloc::evaluation {

void draw_map_over_image(const MapIndex& map, const Se2& map_from_vehicle,
                         const CameraModel& camera, cv::Mat& image) {
  ProjectedMap projected(map);
  for (const ProjectedLine& line : projected.in_image(map_from_vehicle, camera)) {
    const cv::Scalar color = class_color(line.element_class);
    for (size_t i = 1; i < line.points.size(); ++i) {
      const cv::Point2d from(line.points[i - 1].x(), line.points[i - 1].y());
      const cv::Point2d to(line.points[i].x(), line.points[i].y());
      cv::line(image, from, to, color, 2, cv::LINE_AA);
    }
  }
}

}  // namespace bevloc::evaluation
