// The Stanford diagram: how often poses had which error at which protection level.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/campaign/cycle_reader.h"
#include "evaluation/campaign/protection_counts.h"

namespace bevloc::evaluation {

/// Counts of the valid poses of some drives. One thread.
class StanfordDiagram {
 public:
  /// Along error and protection level: 60 bins of a twentieth of the alert limit; what is larger
  /// than three alert limits counts in the last one.
  static constexpr int kBins = 60;
  static constexpr double kBinsPerLimit = 20.0;

  struct Axis {
    std::array<uint64_t, kBins * kBins> counts{};  ///< [protection level, error]
    double worst_excess = 0.0;  ///< largest error beyond the protection level, m or rad
  };

  /// Begins a drive. Call it before the cycles of each drive.
  void begin_drive();
  /// Takes the next cycle of the drive. The counts begin with the first valid pose of the drive.
  void add(const JudgedCycle& cycle);

  int drives() const { return drives_; }
  int drives_with_pose() const { return drives_with_pose_; }
  /// Since the first valid pose of each drive. Cycles of a silent appliance count, too.
  uint64_t cycles() const { return cycles_; }
  uint64_t valid() const { return valid_; }
  const ProtectionCounts& protection() const { return protection_; }
  const Axis& axis(int i) const { return axes_[static_cast<size_t>(i)]; }

 private:
  void count(const JudgedError& pose);

  int drives_ = 0;
  int drives_with_pose_ = 0;
  /// Of the latest cycle, seconds of the drive; empty before the drive's first valid pose.
  std::optional<double> latest_s_;
  uint64_t cycles_ = 0;
  uint64_t valid_ = 0;
  ProtectionCounts protection_;
  std::array<Axis, 3> axes_;  ///< longitudinal, lateral, yaw
};

/// A diagram with its name, such as "no fault".
struct NamedDiagram {
  std::string name;
  StanfordDiagram diagram;
};

/// A table in Markdown, and under it the number of drives that had a valid pose.
std::string to_table(const std::vector<NamedDiagram>& diagrams);
std::string to_json(const std::vector<NamedDiagram>& diagrams);

}  // namespace bevloc::evaluation
