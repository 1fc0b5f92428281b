#include "evaluation/calib/folder_recording.h"

#include <algorithm>

#include "common/image_file.h"

namespace bevloc::evaluation {
namespace {

bool holds_recordings(const std::filesystem::path& folder) {
  std::error_code none;
  const std::filesystem::directory_iterator entries(folder, none);
  return std::any_of(begin(entries), end(entries),
                     [](const auto& entry) { return entry.path().extension() == ".mcap"; });
}

}  // namespace

Result<std::unique_ptr<FolderRecording>> FolderRecording::open(const std::filesystem::path& folder,
                                                               const Rig& rig, Duration interval) {
  if (holds_recordings(folder)) {
    return fail("{}: found recordings (.mcap), wanted a picture folder, as --save-pictures makes",
                folder.string());
  }
  auto reference = ReferenceTrajectory::read(folder / kReferenceFile);
  if (!reference) return tl::unexpected(reference.error());
  auto frames = drivers::load_recordings(folder);
  if (!frames) return tl::unexpected(frames.error());
  std::vector<std::filesystem::path> files{folder / kReferenceFile};
  for (int camera = 0; camera < kCameraCount; ++camera) {
    files.push_back(folder / kCameraNames[camera] / drivers::kFrameIndex);
    for (const drivers::RecordedFrame& frame : (*frames)[camera]) files.push_back(frame.file);
  }
  std::unique_ptr<FolderRecording> opened(
      new FolderRecording(rig, std::move(*reference), interval, std::move(*frames)));
  if (opened->cameras().none()) {
    return fail("{}: found no folder of a camera, wanted folders such as {}", folder.string(),
                kCameraNames[1]);
  }
  opened->files_ = std::move(files);
  return opened;
}

FolderRecording::FolderRecording(const Rig& rig, ReferenceTrajectory reference, Duration interval,
                                 drivers::RecordedFrames frames)
    : rig_(rig), reference_(std::move(reference)), frames_(std::move(frames)) {
  for (size_t camera = 0; camera < kCameraCount; ++camera) {
    cameras_.set(camera, !frames_[camera].empty());
  }
  for (const auto& frameset : drivers::framesets_of(drivers::times_of(frames_))) {
    const bool is_early = !framesets_.empty() && frameset.time - framesets_.back().time < interval;
    if (!is_early) framesets_.push_back(frameset);
  }
}

Status FolderRecording::next(std::vector<RecordedPicture>& pictures) {
  pictures.clear();
  if (next_ == framesets_.size()) return {};
  const drivers::FramesetPlace& frameset = framesets_[next_++];
  const auto frame_of = [&](int camera) -> const drivers::RecordedFrame& {
    return frames_[camera][frameset.frame[camera]];
  };
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (frameset.present[camera]) pictures.push_back({camera, frame_of(camera).time, {}});
  }
  std::ranges::stable_sort(pictures, {}, &RecordedPicture::time);
  RgbImage image;
  for (RecordedPicture& picture : pictures) {
    const Intrinsics& lens = rig_.cameras[picture.camera].intrinsics;
    if (image.width != lens.width_px || image.height != lens.height_px) {
      image = RgbImage(lens.width_px, lens.height_px);
    }
    const std::string file = frame_of(picture.camera).file.string();
    if (Status read = read_camera_picture(file, image); !read) return read;
    picture.image = grey_from(image.view());
  }
  return {};
}

}  // namespace bevloc::evaluation
