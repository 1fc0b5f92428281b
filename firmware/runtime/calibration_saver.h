// Saves what the online calibration learns, while the appliance runs and at its end.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "common/bounded_queue.h"
#include "drivers/clock/clock.h"
#include "firmware/config/config.h"
#include "firmware/stages/vision_stage.h"
#include "pipeline/online_calibration/calibration_file.h"

namespace bevloc::firmware {

/// The vision thread hands over what was learned, at most once in kPeriod, and never waits. Another
/// thread writes it to the file if it differs from the latest content. While a camera is out of
/// place, the file keeps what was known at the start, because that camera has disturbed the
/// estimates of the other cameras before the fault was found.
///
/// Thread-bound: note() is called from the vision thread, write_next() from the saving thread.
/// finish() is called after the vision thread has ended and write_next() is no longer called.
/// close() is thread-safe.
class CalibrationSaver {
 public:
  /// A vehicle that cuts the power without a warning loses what was learned in one minute, in which
  /// the estimate changes little. One file of 17 kB per minute, which is 25 MB in 24 hours of
  /// driving, does not wear a flash memory out.
  static constexpr Duration kPeriod = std::chrono::minutes(1);

  /// The present estimate of `online` counts as saved. `online` must outlive the saver. `rig_crc32`
  /// is the checksum of the rig to which the errors belong.
  CalibrationSaver(const OnlineCalibration& online, uint32_t rig_crc32, std::filesystem::path file);

  /// Makes the stage call note() after each match. Call it before the first step of the stage.
  /// Saver and clock must outlive its last step.
  void watch(VisionStage& vision, const drivers::Clock& clock);

  /// Hands over the estimate for writing, once in kPeriod. Does not allocate.
  void note(Time now);

  /// Waits up to `timeout` for an estimate, and writes it if it is new. Returns whether one was
  /// written. Logs a failure once per cause.
  bool write_next(Duration timeout);

  /// Wakes write_next(), which does not wait from then on.
  void close() { handed_over_.close(); }

  /// Writes the last estimate.
  void finish();

 private:
  LearnedCalibration known() const;
  /// Returns the present estimate, or that of the start while a camera is out of place.
  LearnedCalibration worth_keeping() const;
  bool write(const LearnedCalibration& learned);

  const OnlineCalibration& online_;
  const uint32_t rig_crc32_;
  const std::filesystem::path file_;
  const LearnedCalibration start_;
  std::optional<Time> due_;  ///< when note() hands over next; used by the vision thread only
  BoundedQueue<LearnedCalibration> handed_over_{1};
  LearnedCalibration written_;
  std::string failure_;  ///< why the latest write failed; empty if it did not
};

/// Makes a saver. Returns null if nothing is kept, because there is no calibration.online.file or
/// no online calibration. Call it before the first step of the vision stage. The localizer must
/// outlive the saver.
std::unique_ptr<CalibrationSaver> make_calibration_saver(const Config& config, const Rig& rig,
                                                         const Localizer& localizer);

/// Starts the saving thread. It writes what is handed over, with the lowest priority of the normal
/// scheduler, and finishes when it is asked to stop. Ask it only after the vision thread has ended.
/// No other thread waits for this one before. `saver` must outlive it.
std::jthread start_saving(CalibrationSaver& saver);

}  // namespace bevloc::firmware
