// All recorded drives of a folder as a set of training samples.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/map/hd_map.h"
#include "training/drives/drive_parts.h"
#include "training/drives/mcap_drive.h"
#include "training/drives/recorded_drive.h"

namespace bevloc::drives {

struct DriveSetOptions {
  std::filesystem::path folder;
  ReferenceKind reference = ReferenceKind::kFile;
  std::optional<Rig> rig{};  ///< of all drives; needed for folders of pictures
};

/// One frameset of the set.
struct SamplePlace {
  size_t drive = 0;
  size_t frameset = 0;
};

/// Why framesets of the drives are no samples.
struct LeftOut {
  size_t without_pose = 0;  ///< the reference has no pose at their time
  size_t too_close = 0;     ///< less than kLeastDistance_m and kLeastTurn_rad from the one before
  size_t beside_other_part = 0;  ///< they show a place that their part must not show
};

/// The least and the largest value of the cameras of all drives.
struct CameraRanges {
  double least_focal_px = 0.0;  ///< of the network cameras (network_camera.h)
  double most_focal_px = 0.0;
  double least_height_m = 0.0;  ///< above the ground
  double most_height_m = 0.0;
};

/// Finds the drives of a folder: the folder itself and each folder in it. A folder with MCAP files
/// has one drive for each run of the daemon; one with pictures (FolderDrive) is one drive.
///
/// The place of a sample gives its part (drive_parts.h). So a place that is driven through twice is
/// in one part only.
class DriveSet {
 public:
  /// Two samples of a drive differ by at least one of these.
  static constexpr double kLeastDistance_m = 1.0;
  static constexpr double kLeastTurn_rad = radians(5.0);

  /// Fails if there is no drive, or if a drive cannot be opened.
  static Result<DriveSet> open(const DriveSetOptions& options);

  const std::vector<SamplePlace>& places(DrivePart part) const {
    return places_[static_cast<size_t>(part)];
  }
  CameraRanges camera_ranges() const;
  const LeftOut& left_out() const { return left_out_; }
  RecordedDrive& drive(size_t index) { return *drives_[index]; }
  size_t drives() const { return drives_.size(); }

 private:
  void choose_samples();

  std::vector<std::unique_ptr<RecordedDrive>> drives_;
  std::array<std::vector<SamplePlace>, kDriveParts.size()> places_;
  LeftOut left_out_;
};

}  // namespace bevloc::drives
