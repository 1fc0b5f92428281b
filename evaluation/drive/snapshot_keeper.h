// Selects one localization of a drive for the sheet.
#pragma once

#include <mutex>
#include <optional>
#include <utility>

#include "evaluation/drive/sheet.h"
#include "firmware/stages/vision_stage.h"

namespace bevloc::evaluation {

/// Observes the vision stage. Among the framesets localized after tracking has settled, it keeps
/// the one whose raster shows the most lines. The vision thread calls observe(); take() is called
/// after the run.
class SnapshotKeeper {
 public:
  struct Kept {
    Time frame_time;
    SheetContent content;
  };

  void observe(const firmware::VisionSnapshot& snapshot);

  std::optional<Kept> take() { return std::exchange(kept_, std::nullopt); }

 private:
  /// Counted from the first frameset that was localized while tracking.
  static constexpr Duration kSettling = std::chrono::seconds(5);
  /// A new frameset must show this much more, because copying six images takes time.
  static constexpr double kImprovement = 1.15;

  std::optional<Time> first_tracked_;
  std::optional<Kept> kept_;
  double best_content_ = 0.0;
};

}  // namespace bevloc::evaluation
