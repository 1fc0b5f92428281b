#include "firmware/runtime/calibration_saver.h"

#include <spdlog/spdlog.h>

#include "firmware/threads/realtime.h"

namespace bevloc::firmware {

CalibrationSaver::CalibrationSaver(const OnlineCalibration& online, uint32_t rig_crc32,
                                   std::filesystem::path file)
    : online_(online),
      rig_crc32_(rig_crc32),
      file_(std::move(file)),
      start_(known()),
      written_(start_) {}

LearnedCalibration CalibrationSaver::known() const {
  return {rig_crc32_, online_.filter().errors(), online_.filter().covariance()};
}

LearnedCalibration CalibrationSaver::worth_keeping() const {
  return online_.faults().any() ? start_ : known();
}

void CalibrationSaver::watch(VisionStage& vision, const drivers::Clock& clock) {
  vision.observe([this, &clock](const VisionSnapshot&) { note(clock.now()); });
}

void CalibrationSaver::note(Time now) {
  if (!due_) due_ = now + kPeriod;
  if (now < *due_) return;
  due_ = now + kPeriod;
  handed_over_.push(worth_keeping());
}

bool CalibrationSaver::write_next(Duration timeout) {
  const auto learned = handed_over_.pop(timeout);
  return learned && write(*learned);
}

bool CalibrationSaver::write(const LearnedCalibration& learned) {
  if (learned == written_) return false;
  if (const Status status = save_learned(learned, file_); !status) {
    const std::string& cause = status.error().message;
    if (cause != failure_) {
      spdlog::warn(
          "calibration.online.file: what was learned is lost at a restart: {}; bevlocd must be "
          "able to write this folder",
          cause);
    }
    failure_ = cause;
    return false;
  }
  failure_.clear();
  written_ = learned;
  return true;
}

void CalibrationSaver::finish() {
  write(worth_keeping());
}

std::unique_ptr<CalibrationSaver> make_calibration_saver(const Config& config, const Rig& rig,
                                                         const Localizer& localizer) {
  const OnlineCalibration* online = localizer.online_calibration();
  if (online == nullptr || config.learned_calibration_file.empty()) return nullptr;
  return std::make_unique<CalibrationSaver>(*online, rig_crc32(rig),
                                            config.learned_calibration_file);
}

std::jthread start_saving(CalibrationSaver& saver) {
  return std::jthread([&saver](const std::stop_token& stop) {
    begin_low_thread("calibration");
    const std::stop_callback wake(stop, [&saver] { saver.close(); });
    while (!stop.stop_requested()) saver.write_next(CalibrationSaver::kPeriod);
    saver.finish();
  });
}

}  // namespace bevloc::firmware
