// A recording that a test makes message by message.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "evaluation/recording/recording.h"
#include "firmware/recording/recording_file.h"
#include "firmware/recording/topics.h"

namespace bevloc::test {

/// One file, whose log times are those of the appliance's clock.
class HandMadeRecording {
 public:
  explicit HandMadeRecording(std::filesystem::path path,
                             std::map<std::string, std::string> metadata = {})
      : path_(std::move(path)) {
    firmware::RecordingHead head;
    head.metadata = std::move(metadata);
    head.metadata.emplace(firmware::kClockOffsetKey, "0");
    auto file = firmware::RecordingFile::create(path_, head, ns_of(0.0));
    if (!file) throw std::runtime_error(file.error().message);
    file_.emplace(std::move(*file));
  }

  void add(std::string_view topic, const google::protobuf::Message& message, double time_s) {
    const Status written = file_->write(topic, message, ns_of(time_s), ns_of(time_s));
    EXPECT_TRUE(written) << written.error().message;
  }
  /// A cycle in TRACKING with the vehicle at this place.
  void add_pose(double time_s, double x_m) {
    recording::Solution solution;
    solution.set_state(static_cast<uint32_t>(HealthState::kTracking));
    solution.set_pose_known(true);
    solution.mutable_map_from_vehicle()->set_x_m(x_m);
    add(firmware::kSolutionTopic, solution, time_s);
  }

  /// Ends the file.
  std::filesystem::path finish() {
    EXPECT_TRUE(file_->finish());
    return path_;
  }
  evaluation::Recording open() {
    auto recording = evaluation::Recording::open({finish()});
    if (!recording) throw std::runtime_error(recording.error().message);
    return std::move(*recording);
  }

 private:
  /// The recording begins on the 28th of June 2024.
  static uint64_t ns_of(double time_s) {
    return 1'719'532'800'000'000'000 + static_cast<uint64_t>(1e9 * time_s);
  }

  const std::filesystem::path path_;
  std::optional<firmware::RecordingFile> file_;
};

}  // namespace bevloc::test
