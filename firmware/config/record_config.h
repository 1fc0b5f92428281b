// The section `record` of the configuration: what is recorded, where, and how much is kept.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "common/strict_yaml.h"
#include "common/time.h"

namespace bevloc::firmware {

enum class RecordedImages : uint8_t {
  kJpeg,  ///< small, for reports
  kRaw,   ///< as the camera delivered them: a replay computes the same poses
};

struct RecordConfig {
  std::filesystem::path directory;
  RecordedImages images = RecordedImages::kJpeg;
  int jpeg_quality = 85;
  Duration file_length = std::chrono::seconds(60);
  uint64_t max_bytes = 10'000'000'000;            ///< of all files of the ring
  Duration max_age = std::chrono::hours(24 * 7);  ///< of a file of the ring
  int black_box_files = 40;                       ///< kept after LOST and FAULT
};

/// Empty without the section. Relative paths start at `folder`.
std::optional<RecordConfig> read_record(std::optional<YamlMap> yaml,
                                        const std::filesystem::path& folder);

}  // namespace bevloc::firmware
