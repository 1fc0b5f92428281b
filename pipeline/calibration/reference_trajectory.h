// The vehicle's poses from a reference system, such as RTK GNSS with an IMU.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/result.h"
#include "common/se2.h"
#include "common/time.h"

namespace bevloc {

/// The file of reference poses in a picture folder, or beside the files of a recording.
inline constexpr const char* kReferenceFile = "reference.csv";

/// Poses in the order of time. Immutable, and so thread-safe.
class ReferenceTrajectory {
 public:
  struct Pose {
    Time time;
    Se2 map_from_vehicle;
  };

  /// Reads a text with the header `time_ns,x_m,y_m,yaw_deg` and a pose in each further line. Fails,
  /// with `name` and line, on anything else, on times that are negative or do not increase, and
  /// with fewer than two poses.
  static Result<ReferenceTrajectory> parse(const std::string& text, const std::string& name);

  /// Reads such a text from a file.
  static Result<ReferenceTrajectory> read(const std::filesystem::path& file);

  /// `poses` must be in the order of time.
  explicit ReferenceTrajectory(std::vector<Pose> poses) : poses_(std::move(poses)) {}

  /// Interpolates between two poses that are at most 0.5 s apart. Returns nothing elsewhere.
  std::optional<Se2> at(Time time) const;

  const std::vector<Pose>& poses() const { return poses_; }
  /// The text that parse() reads.
  std::string to_csv() const;

 private:
  std::vector<Pose> poses_;
};

}  // namespace bevloc
