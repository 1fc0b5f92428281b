#include "evaluation/drive/picture_recorder.h"

#include <string_view>
#include <system_error>
#include <vector>

#include "common/files.h"
#include "common/image_file.h"
#include "drivers/camera/replay/replay_camera.h"
#include "pipeline/map/map_binary.h"

namespace bevloc::evaluation {
namespace {

constexpr const char* kMapFile = "map.bvm";

}  // namespace

Status PictureRecorder::begin() {
  if (Status made = create_folder(folder_); !made) return made;
  std::vector<std::filesystem::path> earlier{folder_ / kReferenceFile, folder_ / kMapFile};
  for (const std::string_view camera : kCameraNames) {
    earlier.push_back(folder_ / camera / drivers::kFrameIndex);
  }
  for (const std::filesystem::path& file : earlier) {
    std::error_code error;
    std::filesystem::remove(file, error);
    if (error) {
      return fail("{}: cannot remove this file of an earlier drive ({}), wanted a new folder",
                  file.string(), error.message());
    }
  }
  return {};
}

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
  if (Status s = write_file(folder_ / kReferenceFile, reference.to_csv()); !s) return s;
  return write_map_binary(map, folder_ / kMapFile);
}

}  // namespace bevloc::evaluation
