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
  kRaw,   ///< as the camera delivered them, so that a replay computes the same poses
};

struct RecordConfig {
  std::filesystem::path directory;
  RecordedImages images = RecordedImages::kJpeg;
  int jpeg_quality = 85;
  Duration file_length = std::chrono::seconds(60);
  uint64_t max_bytes = 10'000'000'000;            ///< size of all files of the ring
  Duration max_age = std::chrono::hours(24 * 7);  ///< age of a file of the ring
  int black_box_files = 40;  ///< number of files that are kept after LOST and FAULT
};

/// Reads the section. Returns nothing if there is none. Relative paths start at `folder`.
std::optional<RecordConfig> read_record(std::optional<YamlMap> yaml,
                                        const std::filesystem::path& folder);

}  // namespace bevloc::firmware
