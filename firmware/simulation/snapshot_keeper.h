// Keeps one localization of a drive for the sheet.
#pragma once

#include <mutex>
#include <optional>
#include <utility>

#include "firmware/simulation/sheet.h"
#include "firmware/vision_stage.h"

namespace bevloc::firmware {

/// Observes the vision stage; of the framesets localized once tracking has settled it keeps the one
/// around which the map shows most. Threads: observe() in the vision thread, the rest after the
/// run.
class SnapshotKeeper {
 public:
  struct Kept {
    Time frame_time;
    SheetContent content;
  };

  void observe(const VisionSnapshot& snapshot);

  std::optional<Kept> take() { return std::exchange(kept_, std::nullopt); }

 private:
  /// From the first frameset that was localized while tracking.
  static constexpr Duration kSettling = std::chrono::seconds(5);
  /// A better one must show this much more: copying six images costs time in the vision thread.
  static constexpr double kImprovement = 1.15;

  std::optional<Time> first_tracked_;
  std::optional<Kept> kept_;
  double best_content_ = 0.0;
};

}  // namespace bevloc::firmware
