// The fixture of the tests of the recorder.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "drivers/camera/frame_pool.h"
#include "firmware/recording/recorder.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::test {

/// The log time when the clock is zero. It lies after 2038, when 32 bits of seconds overflow.
inline constexpr Duration kRecorderOffset =
    std::chrono::sys_days(std::chrono::year(2040) / 3 / 1).time_since_epoch();

/// A recorder of raw images of 16 x 8 pixels of the first camera, in a folder of its own.
class RecorderFixture : public testing::Test {
 protected:
  RecorderFixture() {
    config_.directory = folder_ / "ring";
    config_.images = firmware::RecordedImages::kRaw;
  }

  std::unique_ptr<firmware::Recorder> open() {
    auto recorder = firmware::Recorder::open(config_, {}, kRecorderOffset, Time{});
    EXPECT_TRUE(recorder) << recorder.error().message;
    (*recorder)->expect_images(0, 16, 8);
    return std::move(*recorder);
  }

  static can::PoseReport report(HealthState state, Time time) {
    can::PoseReport report;
    report.status.state = state;
    report.pose_time = time;
    return report;
  }

  drivers::Frame frame(uint64_t sequence, Time time) {
    drivers::FrameBuffer buffer = pool_->borrow();
    std::ranges::fill(pool_->image(buffer).pixels, static_cast<uint8_t>(sequence));
    return {0, time, sequence, std::chrono::milliseconds(8), std::move(buffer)};
  }

  /// A frame that compression does not make tiny.
  drivers::Frame noisy_frame(uint64_t sequence, Time time, int seed) {
    drivers::Frame noisy = frame(sequence, time);
    uint8_t value = 1;
    for (uint8_t& byte : pool_->image(noisy.buffer).pixels) {
      value = static_cast<uint8_t>(value * 29 + 7 + seed);
      byte = static_cast<uint8_t>(value ^ (value >> 3));
    }
    return noisy;
  }

  uintmax_t bytes_in_ring() const {
    uintmax_t bytes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(config_.directory)) {
      if (entry.is_regular_file()) bytes += entry.file_size();
    }
    return bytes;
  }

  /// A file of an earlier run.
  std::filesystem::path leave(const std::string& name, size_t bytes) const {
    const std::filesystem::path path = config_.directory / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << std::string(bytes, 'x');
    return path;
  }

  static size_t files_in(const std::filesystem::path& folder) {
    size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      count += entry.is_regular_file();
    return count;
  }

  static std::filesystem::path first_in(const std::filesystem::path& folder) {
    std::filesystem::path first;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.is_regular_file() && (first.empty() || entry.path() < first)) first = entry.path();
    }
    return first;
  }

  const TemporaryFolder folder_;
  firmware::RecordConfig config_;
  std::shared_ptr<drivers::FramePool> pool_ = drivers::FramePool::create(32, 16, 8);
};

}  // namespace bevloc::test
