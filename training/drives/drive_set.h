// All recorded drives of a folder as a set of training samples.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/map/hd_map.h"
#include "training/drives/mcap_drive.h"
#include "training/drives/recorded_drive.h"

namespace bevloc::drives {

/// Which places the samples are from. No sample of training shows a place that is held back.
enum class DrivePart : uint8_t { kTraining, kHeldBack };

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
  size_t beside_held_back = 0;  ///< they show a part of a place that is held back
};

/// Finds the drives of a folder: the folder itself and each folder in it. A folder with MCAP files
/// has one drive for each run of the daemon; one with pictures (FolderDrive) is one drive.
///
/// The map is divided into squares of kSquare_m. In the order in which the drives reach them, every
/// kHeldBackEvery-th one is held back, so a place that is driven through twice is on one side only.
class DriveSet {
 public:
  /// Two samples of a drive differ by at least one of these.
  static constexpr double kLeastDistance_m = 1.0;
  static constexpr double kLeastTurn_rad = radians(5.0);
  static constexpr double kSquare_m = 100.0;
  static constexpr int kHeldBackEvery = 4;
  /// How far from its reference pose a sample shows the map, at any heading: 30 m along and 15 m
  /// across (kRasterGrid) from a prior that is up to 2 m and 1 m off (sim::random_correction()).
  static constexpr double kSeen_m = 36.0;

  /// Fails if there is no drive, or if a drive cannot be opened.
  static Result<DriveSet> open(const DriveSetOptions& options);

  const std::vector<SamplePlace>& places(DrivePart part) const {
    return part == DrivePart::kTraining ? training_ : held_back_;
  }
  const LeftOut& left_out() const { return left_out_; }
  RecordedDrive& drive(size_t index) { return *drives_[index]; }
  size_t drives() const { return drives_.size(); }

 private:
  void choose_samples();

  std::vector<std::unique_ptr<RecordedDrive>> drives_;
  std::vector<SamplePlace> training_;
  std::vector<SamplePlace> held_back_;
  LeftOut left_out_;
};

}  // namespace bevloc::drives
