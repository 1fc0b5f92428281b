#include "training/drives/mcap_drive.h"

#include <fmt/format.h>

#include "evaluation/recording/played_devices.h"
#include "evaluation/recording/track.h"
#include "firmware/recording/topics.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/online_calibration/calibration_file.h"
#include "training/drives/own_track.h"

namespace bevloc::drives {
namespace {

using evaluation::MessagePlace;
using evaluation::Recording;

Result<Rig> recorded_rig(const Recording& recording, const std::string& name) {
  const mcap::Attachment* text = recording.attachment(firmware::kRigAttachment);
  if (text == nullptr) return fail("{}: found no rig file in it, wanted one; give --rig", name);
  auto rig =
      parse_rig(std::string(text->data), name + ": " + std::string(firmware::kRigAttachment));
  const mcap::Attachment* learned = recording.attachment(firmware::kLearnedAttachment);
  if (!rig || learned == nullptr) return rig;
  const auto errors = parse_learned(std::string(learned->data),
                                    name + ": " + std::string(firmware::kLearnedAttachment));
  if (!errors) return tl::unexpected(errors.error());
  if (errors->rig_crc32 == rig_crc32(*rig)) apply_errors(errors->errors, *rig);
  return rig;
}

/// Poses with times since 1970, moved to the clock of the recording.
ReferenceTrajectory on_recorded_clock(const ReferenceTrajectory& reference,
                                      const Recording& recording) {
  std::vector<ReferenceTrajectory::Pose> poses = reference.poses();
  for (ReferenceTrajectory::Pose& pose : poses) {
    pose.time = recording.clock_time(static_cast<uint64_t>(pose.time.time_since_epoch().count()));
  }
  return ReferenceTrajectory(std::move(poses));
}

Result<ReferenceTrajectory> recorded_truth(Recording& recording, const std::string& name) {
  const auto track = evaluation::read_track(recording, firmware::kTruthTopic);
  if (!track) return tl::unexpected(track.error());
  if (track->size() < 2) {
    return fail("{}: found no truth, wanted the recording of a simulated drive", name);
  }
  std::vector<ReferenceTrajectory::Pose> poses;
  for (const auto& [time, pose] : *track) poses.push_back({time, pose});
  return ReferenceTrajectory(std::move(poses));
}

Result<ReferenceTrajectory> reference_of(Recording& recording, ReferenceKind kind,
                                         const std::filesystem::path& folder,
                                         const std::string& name) {
  if (kind == ReferenceKind::kOwn) return own_track(recording);
  if (kind == ReferenceKind::kTruth) return recorded_truth(recording, name);
  const auto reference = ReferenceTrajectory::read(folder / kReferenceFile);
  if (!reference) return reference;
  return on_recorded_clock(*reference, recording);
}

}  // namespace

Result<std::unique_ptr<RecordedDrive>> McapDrive::open(
    const std::vector<std::filesystem::path>& files, ReferenceKind kind,
    const std::optional<Rig>& rig) {
  auto recording = Recording::open(files);
  if (!recording) return tl::unexpected(recording.error());
  for (const std::string& gap : recording->gaps()) fmt::print(stderr, "{}\n", gap);
  const std::string name = files.front().string();
  auto used_rig = rig ? Result<Rig>(*rig) : recorded_rig(*recording, name);
  if (!used_rig) return tl::unexpected(used_rig.error());
  auto reference = reference_of(*recording, kind, files.front().parent_path(), name);
  if (!reference) return tl::unexpected(reference.error());
  drivers::FrameTimes times;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    for (const MessagePlace& place : recording->messages(firmware::image_topic(camera))) {
      times[camera].push_back(recording->clock_time(place.publish_time_ns));
    }
  }
  DriveIndex index{name, *used_rig, std::move(*reference), drivers::framesets_of(times)};
  return std::unique_ptr<RecordedDrive>(new McapDrive(std::move(index), std::move(*recording)));
}

Result<Time> McapDrive::read(const FramesetPlace& frameset, int camera,
                             ImagePreprocessor& preprocessor, std::span<int8_t> planes) {
  const auto frame = evaluation::read_recorded_frame(recording_, camera, frameset.frame[camera],
                                                     index().rig.cameras[camera].intrinsics);
  if (!frame) return tl::unexpected(frame.error());
  if (Status status = preprocessor.run(frame->image(), planes); !status) {
    return tl::unexpected(status.error());
  }
  return frame->time;
}

}  // namespace bevloc::drives
