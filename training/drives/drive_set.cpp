#include "training/drives/drive_set.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "common/mcap/reader.h"
#include "firmware/recording/topics.h"
#include "pipeline/preprocessing/network_camera.h"
#include "training/drives/folder_drive.h"

namespace bevloc::drives {
namespace {

namespace fs = std::filesystem;

bool is_drive_of_pictures(const fs::path& folder) {
  return std::ranges::any_of(kCameraNames, [&](std::string_view camera) {
    std::error_code unreadable;  // entries_of() names the folder
    return fs::exists(folder / camera / "frames.txt", unreadable);
  });
}

/// The paths in a folder, sorted.
Result<std::vector<fs::path>> entries_of(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> entries;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    entries.push_back(entry->path());
  }
  if (error) {
    return fail("{}: found no way to list this folder ({}), wanted a readable one", folder.string(),
                error.message());
  }
  std::ranges::sort(entries);
  return entries;
}

/// Fails for a link that leads nowhere or in a circle.
Result<bool> is_folder(const fs::path& path) {
  std::error_code error;
  const fs::file_status found = fs::status(path, error);
  if (fs::exists(found)) return fs::is_directory(found);
  return fail("{}: found no file or folder behind this name ({}), wanted one", path.string(),
              error.message());
}

/// The MCAP files of a folder, those of each run together.
Result<std::vector<std::vector<fs::path>>> runs_in(const fs::path& folder) {
  const auto entries = entries_of(folder);
  if (!entries) return tl::unexpected(entries.error());
  std::map<std::string, std::vector<fs::path>> by_run;
  for (const fs::path& entry : *entries) {
    if (entry.extension() != ".mcap") continue;
    const auto reader = mcap::Reader::open(entry);
    if (!reader) return tl::unexpected(reader.error());
    const mcap::Metadata* metadata = reader->metadata(firmware::kMetadataName);
    const std::string key(firmware::kClockOffsetKey);
    const bool known = metadata != nullptr && metadata->values.contains(key);
    by_run[known ? metadata->values.at(key) : ""].push_back(entry);
  }
  std::vector<std::vector<fs::path>> runs;
  for (auto& [key, files] : by_run) runs.push_back(std::move(files));
  std::ranges::sort(runs);
  return runs;
}

/// The folder itself, and the folders in it that may have drives of their own.
Result<std::vector<fs::path>> folders_of_drives(const fs::path& folder) {
  std::vector<fs::path> folders{folder};
  // All folders in a folder of pictures belong to its cameras.
  if (is_drive_of_pictures(folder)) return folders;
  const auto entries = entries_of(folder);
  if (!entries) return tl::unexpected(entries.error());
  for (const fs::path& entry : *entries) {
    // The black box has links to files that belong to other drives already.
    if (entry.filename() == firmware::kBlackBoxFolder) continue;
    const auto found = is_folder(entry);
    if (!found) return tl::unexpected(found.error());
    if (*found) folders.push_back(entry);
  }
  return folders;
}

/// Appends the drives of a folder, but not those of the folders in it.
Status add_drives(const fs::path& folder, const DriveSetOptions& options,
                  std::vector<std::unique_ptr<RecordedDrive>>& drives) {
  if (is_drive_of_pictures(folder)) {
    if (!options.rig) {
      return fail("{}: found pictures without a calibration, wanted one; give --rig",
                  folder.string());
    }
    auto drive = FolderDrive::open(folder, *options.rig);
    if (!drive) return tl::unexpected(drive.error());
    drives.push_back(std::move(*drive));
    return {};
  }
  const auto runs = runs_in(folder);
  if (!runs) return tl::unexpected(runs.error());
  for (const auto& files : *runs) {
    auto drive = McapDrive::open(files, options.reference, options.rig);
    if (!drive) return tl::unexpected(drive.error());
    drives.push_back(std::move(*drive));
  }
  return {};
}

/// The framesets of a drive that are far enough from each other, with their poses.
std::vector<std::pair<size_t, Se2>> spaced_framesets(const DriveIndex& drive, LeftOut& left_out) {
  std::vector<std::pair<size_t, Se2>> chosen;
  for (size_t i = 0; i < drive.framesets.size(); ++i) {
    const Time time = drive.framesets[i].time;
    const auto pose = drive.reference.at(time);
    if (!pose || !drive.reference.at(time + kWidestSpread)) {
      ++left_out.without_pose;
      continue;
    }
    const bool is_close = !chosen.empty() &&
                          (pose->translation() - chosen.back().second.translation()).norm() <
                              DriveSet::kLeastDistance_m &&
                          std::abs(wrap_angle(pose->yaw_rad - chosen.back().second.yaw_rad)) <
                              DriveSet::kLeastTurn_rad;
    if (is_close) {
      ++left_out.too_close;
    } else {
      chosen.emplace_back(i, *pose);
    }
  }
  return chosen;
}

}  // namespace

Result<DriveSet> DriveSet::open(const DriveSetOptions& options) {
  std::error_code error;
  if (!fs::is_directory(options.folder, error)) {
    return fail("{}: found no folder, wanted one with recordings", options.folder.string());
  }
  const auto folders = folders_of_drives(options.folder);
  if (!folders) return tl::unexpected(folders.error());
  DriveSet set;
  for (const fs::path& folder : *folders) {
    if (Status added = add_drives(folder, options, set.drives_); !added) {
      return tl::unexpected(added.error());
    }
  }
  if (set.drives_.empty()) {
    return fail("{}: found no drive, wanted MCAP files of bevloc, or {}/frames.txt",
                options.folder.string(), kCameraNames[0]);
  }
  set.choose_samples();
  return set;
}

void DriveSet::choose_samples() {
  for (size_t drive = 0; drive < drives_.size(); ++drive) {
    for (const auto& [frameset, pose] : spaced_framesets(drives_[drive]->index(), left_out_)) {
      if (const auto part = part_at(pose.translation())) {
        places_[static_cast<size_t>(*part)].push_back({drive, frameset});
      } else {
        ++left_out_.beside_other_part;
      }
    }
  }
}

CameraRanges DriveSet::camera_ranges() const {
  std::vector<double> focal_px;
  std::vector<double> height_m;
  for (const auto& drive : drives_) {
    for (const CameraModel& camera : network_rig(drive->index().rig).cameras) {
      focal_px.push_back(camera.intrinsics.fx_px);
      height_m.push_back(camera.vehicle_from_camera.translation_m.z());
    }
  }
  const auto [least_px, most_px] = std::ranges::minmax(focal_px);
  const auto [least_m, most_m] = std::ranges::minmax(height_m);
  return {least_px, most_px, least_m, most_m};
}

}  // namespace bevloc::drives
