#include "training/drives/drive_set.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "common/mcap/reader.h"
#include "firmware/recording/topics.h"
#include "training/drives/folder_drive.h"

namespace bevloc::drives {
namespace {

namespace fs = std::filesystem;
using Square = std::pair<long, long>;

Square square_at(const Eigen::Vector2d& place) {
  return {std::lround(std::floor(place.x() / DriveSet::kSquare_m)),
          std::lround(std::floor(place.y() / DriveSet::kSquare_m))};
}

double distance_to(const Square& square, const Eigen::Vector2d& place) {
  const Eigen::Vector2d low(DriveSet::kSquare_m * static_cast<double>(square.first),
                            DriveSet::kSquare_m * static_cast<double>(square.second));
  const Eigen::Vector2d high = low.array() + DriveSet::kSquare_m;
  return (place - place.cwiseMax(low).cwiseMin(high)).norm();
}

bool is_drive_of_pictures(const fs::path& folder) {
  return std::ranges::any_of(kCameraNames, [&](std::string_view camera) {
    return fs::exists(folder / camera / "frames.txt");
  });
}

/// The MCAP files of a folder, those of each run together.
Result<std::vector<std::vector<fs::path>>> runs_in(const fs::path& folder) {
  std::map<std::string, std::vector<fs::path>> by_run;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".mcap") continue;
    const auto reader = mcap::Reader::open(entry.path());
    if (!reader) return tl::unexpected(reader.error());
    const mcap::Metadata* metadata = reader->metadata(firmware::kMetadataName);
    const std::string key(firmware::kClockOffsetKey);
    const bool known = metadata != nullptr && metadata->values.contains(key);
    by_run[known ? metadata->values.at(key) : ""].push_back(entry.path());
  }
  std::vector<std::vector<fs::path>> runs;
  for (auto& [key, files] : by_run) {
    std::ranges::sort(files);
    runs.push_back(std::move(files));
  }
  std::ranges::sort(runs);
  return runs;
}

/// Appends the drives of a folder, without those in folders in it.
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
  std::vector<fs::path> folders{options.folder};
  for (const auto& entry : fs::directory_iterator(options.folder)) {
    // The black box has second names of files that are drives already.
    const bool black_box = entry.path().filename() == firmware::kBlackBoxFolder;
    if (entry.is_directory() && !black_box) folders.push_back(entry.path());
  }
  std::sort(folders.begin() + 1, folders.end());
  DriveSet set;
  for (const fs::path& folder : folders) {
    if (Status added = add_drives(folder, options, set.drives_); !added) {
      return tl::unexpected(added.error());
    }
    // The folders in it are those of its cameras.
    if (&folder == &folders.front() && is_drive_of_pictures(folder)) break;
  }
  if (set.drives_.empty()) {
    return fail("{}: found no drive, wanted MCAP files of bevloc, or {}/frames.txt",
                options.folder.string(), kCameraNames[0]);
  }
  set.choose_samples();
  return set;
}

void DriveSet::choose_samples() {
  std::vector<std::vector<std::pair<size_t, Se2>>> chosen;
  std::set<Square> visited;
  std::set<Square> held_back;
  for (const auto& drive : drives_) {
    chosen.push_back(spaced_framesets(drive->index(), left_out_));
    for (const auto& [frameset, pose] : chosen.back()) {
      const Square square = square_at(pose.translation());
      if (!visited.insert(square).second) continue;
      if (visited.size() % kHeldBackEvery == 0) held_back.insert(square);
    }
  }
  for (size_t drive = 0; drive < chosen.size(); ++drive) {
    for (const auto& [frameset, pose] : chosen[drive]) {
      const Eigen::Vector2d place = pose.translation();
      if (held_back.contains(square_at(place))) {
        held_back_.push_back({drive, frameset});
        continue;
      }
      const bool shows_held_back = std::ranges::any_of(
          held_back, [&](const Square& square) { return distance_to(square, place) < kSeen_m; });
      if (shows_held_back) {
        ++left_out_.beside_held_back;
      } else {
        training_.push_back({drive, frameset});
      }
    }
  }
}

}  // namespace bevloc::drives
