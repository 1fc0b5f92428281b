// All recorded drives of a folder as a set of training samples.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/map/hd_map.h"
#include "training/drives/mcap_drive.h"
#include "training/drives/recorded_drive.h"

namespace bevloc::drives {

/// Which places the samples are from. No sample shows a place of a part that comes later in this
/// list.
enum class DrivePart : uint8_t {
  kTraining,     ///< the network learns from them
  kCalibration,  ///< for the ranges of int8, the scales of the solvers and the early stop
  kHeldBack,     ///< for the figures of a report
};

/// All parts with their names on the command line.
inline constexpr std::array<std::pair<std::string_view, DrivePart>, 3> kDriveParts{
    {{"training", DrivePart::kTraining},
     {"calibration", DrivePart::kCalibration},
     {"held-back", DrivePart::kHeldBack}}};

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
/// The map is divided into squares of kSquare_m, which are numbered in the order in which the
/// drives reach them. Every kSetAsideEvery-th one is set aside: the first is held back, the second
/// is for calibration, and so on in turn. So a place that is driven through twice is in one part
/// only.
class DriveSet {
 public:
  /// Two samples of a drive differ by at least one of these.
  static constexpr double kLeastDistance_m = 1.0;
  static constexpr double kLeastTurn_rad = radians(5.0);
  static constexpr double kSquare_m = 100.0;
  static constexpr int kSetAsideEvery = 4;
  static constexpr int kFewestSquares = 2 * kSetAsideEvery;  ///< with fewer, a part has no sample
  /// How far from its reference pose a sample shows the map, at any heading: 30 m along and 15 m
  /// across (kRasterGrid) from a prior that is up to 2 m and 1 m off (sim::random_correction()).
  static constexpr double kSeen_m = 36.0;

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
