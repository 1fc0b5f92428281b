// What the stages hand to the recorder, as plain values that a queue can move.
#pragma once

#include <array>
#include <optional>
#include <variant>

#include "can/bus/frame.h"
#include "can/messages/pose_report.h"
#include "common/se2.h"
#include "common/time.h"
#include "drivers/camera/frame.h"
#include "drivers/gnss/fix_clock.h"
#include "drivers/gnss/gpsd_report.h"
#include "pipeline/solver/solver_result.h"

namespace bevloc::firmware {

/// A frame that the appliance sent or received at `time`.
struct RecordedBusFrame {
  Time time;
  bool sent = false;
  can::Frame frame;
  Time stamp;  ///< time of arrival
};

/// A position of gpsd that was used.
struct RecordedFix {
  Time time;  ///< when the appliance got it
  drivers::GnssFix fix;
  drivers::FixTime held;  ///< the moment of the position
};

struct RecordedSolution {
  can::PoseReport report;
};

/// The vehicle's real pose, which only a simulated drive knows.
struct RecordedTruth {
  Time time;
  Se2 map_from_vehicle;
};

using RecordedEvent = std::variant<RecordedBusFrame, RecordedFix, RecordedSolution, RecordedTruth>;

/// One distribution of a match. If it has more hypotheses than fit, it is not recorded and `count`
/// is 0.
struct RecordedDistribution {
  static constexpr size_t kMost = 256;
  std::array<float, kMost> probability{};
  size_t count = 0;
};

struct RecordedMatch {
  Time time;        ///< when the match was finished
  Time frame_time;  ///< time of the frameset
  unsigned cameras = 0;
  bool acquiring = false;
  Se2 prior;
  MatchResult match;
  std::array<double, 3> ranges{};  ///< x m, y m, yaw rad
  std::array<RecordedDistribution, 3> distributions;
};

/// A copy of an image in the recorder's memory, without padding between rows.
struct RecordedImage {
  int camera = 0;
  Time time;  ///< when the appliance got the frame
  Time exposure_start;
  Duration exposure{};
  uint64_t sequence = 0;
  drivers::FrameBuffer memory;
  ImageView image;  ///< the image in `memory`
};

}  // namespace bevloc::firmware
