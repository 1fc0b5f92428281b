#include "evaluation/drive/picture_recorder.h"

#include "common/files.h"
#include "common/image_file.h"
#include "drivers/camera/replay/replay_camera.h"
#include "pipeline/map/map_binary.h"

namespace bevloc::evaluation {

void PictureRecorder::record(const drivers::Frameset& frameset) {
  if (status_) status_ = write_pictures(frameset);
}

Status PictureRecorder::write_pictures(const drivers::Frameset& frameset) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (!frameset.present[camera]) continue;
    const drivers::Frame& frame = frameset.frames[camera];
    const std::filesystem::path directory = folder_ / kCameraNames[camera];
    if (Status made = create_folder(directory); !made) return made;
    const std::string name = fmt::format("{:06}.png", count_);
    if (Status s = write_png(frame.pixels(), (directory / name).string()); !s) return s;
    indexes_[camera] +=
        fmt::format("{} {} {}\n", count_, frame.time.time_since_epoch().count(), name);
  }
  ++count_;
  return {};
}

Status PictureRecorder::finish(const ReferenceTrajectory& reference, const HdMap& map) {
  if (!status_) return status_;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (indexes_[camera].empty()) continue;
    const auto index = folder_ / kCameraNames[camera] / drivers::kFrameIndex;
    if (Status s = write_file(index, indexes_[camera]); !s) return s;
  }
  if (Status s = write_file(folder_ / "reference.csv", reference.to_csv()); !s) return s;
  return write_map_binary(map, folder_ / "map.bvm");
}

}  // namespace bevloc::evaluation
