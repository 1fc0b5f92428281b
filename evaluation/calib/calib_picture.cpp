#include "evaluation/calib/calib_picture.h"

#include <opencv2/imgproc.hpp>

#include "common/picture_file.h"
#include "evaluation/drive/drawing.h"
#include "evaluation/drive/map_overlay.h"

namespace bevloc::evaluation {
namespace {

constexpr int kPictureWidth_px = 640;
constexpr int kPictureHeight_px = 360;
constexpr int kGap_px = 8;
constexpr int kTitle_px = 40;
constexpr int kPicturesPerRow = 3;

/// Writes a camera's name with a dark border, so that it is read on a bright sky, too.
void write_name(std::string_view name, cv::Mat& picture) {
  const cv::Scalar black(0, 0, 0);
  const cv::Scalar yellow(0, 255, 255);
  for (const auto& [color, thickness_px] : {std::pair(black, 3), std::pair(yellow, 1)}) {
    cv::putText(picture, std::string(name), {10, 24}, cv::FONT_HERSHEY_SIMPLEX, 0.6, color,
                thickness_px, cv::LINE_AA);
  }
}

void draw_picture(const CalibrationView& view, const RecordedPicture& picture,
                  const ReferenceTrajectory& reference, const MapIndex& map, cv::Mat place) {
  cv::Mat grey(picture.image.height, picture.image.width, CV_8UC1,
               const_cast<uint8_t*>(picture.image.pixels.data()));
  cv::Mat shown;
  cv::cvtColor(grey, shown, cv::COLOR_GRAY2BGR);
  const double offset_s = view.time_offset_s[static_cast<size_t>(picture.camera)];
  const auto pose = reference.at(picture.time + from_seconds(offset_s));
  if (pose) draw_map_over_image(map, *pose, view.rig.cameras[picture.camera], shown);
  cv::resize(shown, place, place.size(), 0, 0, cv::INTER_AREA);
  write_name(kCameraNames[picture.camera], place);
}

}  // namespace

Status write_calibration_picture(const std::vector<CalibrationView>& views,
                                 const std::vector<RecordedPicture>& pictures,
                                 const ReferenceTrajectory& reference, const MapIndex& map,
                                 const std::string& file) {
  const int block_px = kTitle_px + 2 * (kPictureHeight_px + kGap_px);
  cv::Mat sheet(static_cast<int>(views.size()) * block_px,
                kPicturesPerRow * (kPictureWidth_px + kGap_px) + kGap_px, CV_8UC3, kPaper);
  for (size_t i = 0; i < views.size(); ++i) {
    const int top_px = static_cast<int>(i) * block_px;
    write_text(sheet, views[i].title, {kGap_px, top_px + 28}, 0.8);
    for (const RecordedPicture& picture : pictures) {
      const cv::Rect place(
          kGap_px + picture.camera % kPicturesPerRow * (kPictureWidth_px + kGap_px),
          top_px + kTitle_px + picture.camera / kPicturesPerRow * (kPictureHeight_px + kGap_px),
          kPictureWidth_px, kPictureHeight_px);
      draw_picture(views[i], picture, reference, map, sheet(place));
    }
  }
  return write_picture(sheet, file);
}

}  // namespace bevloc::evaluation
