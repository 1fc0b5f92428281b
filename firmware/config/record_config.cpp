#include "firmware/config/record_config.h"

#include <string>

namespace bevloc::firmware {

std::optional<RecordConfig> read_record(std::optional<YamlMap> yaml,
                                        const std::filesystem::path& folder) {
  if (!yaml) return std::nullopt;
  RecordConfig record;
  record.directory =
      folder / yaml->require<std::string>("directory", not_empty("the name of a folder"));
  record.images = yaml->optional_choice<RecordedImages>(
      "images", record.images, {{"jpeg", RecordedImages::kJpeg}, {"raw", RecordedImages::kRaw}});
  record.jpeg_quality = yaml->optional<int>("jpeg_quality", record.jpeg_quality, between(10, 100));
  record.file_length = from_seconds(
      yaml->optional<double>("file_s", to_seconds(record.file_length), between(1.0, 3600.0)));
  constexpr double kMega = 1e6;
  record.max_bytes = static_cast<uint64_t>(
      kMega * yaml->optional<double>("max_mb", static_cast<double>(record.max_bytes) / kMega,
                                     between(10.0, 1e8)));
  constexpr double kHour_s = 3600.0;
  record.max_age = from_seconds(
      kHour_s *
      yaml->optional<double>("max_age_h", to_seconds(record.max_age) / kHour_s, between(0.1, 1e5)));
  record.black_box_files =
      yaml->optional<int>("black_box_files", record.black_box_files, between(2, 10'000));
  return record;
}

}  // namespace bevloc::firmware
