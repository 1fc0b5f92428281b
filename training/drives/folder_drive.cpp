#include "training/drives/folder_drive.h"

#include "common/image_file.h"

namespace bevloc::drives {

Result<std::unique_ptr<RecordedDrive>> FolderDrive::open(const std::filesystem::path& folder,
                                                         const Rig& rig) {
  auto reference = ReferenceTrajectory::read(folder / kReferenceFile);
  if (!reference) return tl::unexpected(reference.error());
  auto frames = drivers::load_recordings(folder);
  if (!frames) return tl::unexpected(frames.error());
  DriveIndex index{folder.string(), rig, std::move(*reference),
                   drivers::framesets_of(drivers::times_of(*frames))};
  return std::unique_ptr<RecordedDrive>(new FolderDrive(std::move(index), std::move(*frames)));
}

Result<Time> FolderDrive::read(const FramesetPlace& frameset, int camera,
                               ImagePreprocessor& preprocessor, std::span<int8_t> planes) {
  const drivers::RecordedFrame& frame = frames_[camera][frameset.frame[camera]];
  const Intrinsics& lens = index().rig.cameras[camera].intrinsics;
  if (image_.width != lens.width_px || image_.height != lens.height_px) {
    image_ = RgbImage(lens.width_px, lens.height_px);
  }
  if (Status status = read_camera_picture(frame.file.string(), image_); !status) {
    return tl::unexpected(status.error());
  }
  if (Status status = preprocessor.run(ImageView(image_.view()), planes); !status) {
    return tl::unexpected(status.error());
  }
  return frame.time;
}

}  // namespace bevloc::drives
