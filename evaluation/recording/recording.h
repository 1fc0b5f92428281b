// Reads the files of one recording.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/mcap/reader.h"
#include "common/time.h"
#include "firmware/recording/messages.h"
#include "pipeline/map/hd_map.h"

namespace bevloc::evaluation {

/// Where a message is. Times are since 1970.
struct MessagePlace {
  uint64_t log_time_ns = 0;
  uint64_t publish_time_ns = 0;  ///< of an image: when its exposure started
  uint32_t file = 0;
  uint32_t chunk = 0;
  uint32_t index = 0;  ///< in the chunk
};

/// One or more files that one run of the daemon wrote. Keeps the places of all messages in memory,
/// but only a few chunks of the messages themselves. One thread.
class Recording {
 public:
  /// Fails if a file is no recording of bevloc, or if two files are of different runs. Reads a file
  /// with a damaged chunk only up to that chunk.
  static Result<Recording> open(const std::vector<std::filesystem::path>& files);

  /// The places of all messages of a topic, in the order of time.
  const std::vector<MessagePlace>& messages(std::string_view topic) const;

  /// Parses the message at this place.
  template <typename T>
  Result<T> read(const MessagePlace& place) {
    const auto bytes = bytes_of(place);
    if (!bytes) return tl::unexpected(bytes.error());
    T message;
    if (message.ParseFromArray(bytes->data(), static_cast<int>(bytes->size()))) return message;
    return fail("{}: found a damaged message, wanted a {}", names_[place.file],
                message.GetDescriptor()->full_name());
  }
  /// Whether the messages of this topic have this schema.
  bool has_schema(std::string_view topic, std::string_view schema) const;

  /// An entry of the metadata; empty if it is missing.
  std::string value(std::string_view key) const;
  /// The attachment with this name; null if there is none.
  const mcap::Attachment* attachment(std::string_view name) const;

  /// The time on the appliance's clock at this log time.
  Time clock_time(uint64_t log_time_ns) const {
    return Time(Duration(static_cast<int64_t>(log_time_ns)) - offset_);
  }
  /// The recorded map; nothing if it was too large.
  Result<std::optional<HdMap>> map();

  /// Log times of the first and the last message, without those at the head of each file.
  uint64_t begin_ns() const { return begin_ns_; }
  uint64_t end_ns() const { return end_ns_; }
  /// The files without their end: the process was ended or the power was cut.
  const std::vector<std::string>& cut_files() const { return cut_files_; }
  /// What is missing from the files, one sentence each, for stderr.
  std::vector<std::string> gaps() const;
  /// A time without a solution.
  struct Pause {
    uint64_t begin_ns = 0;
    uint64_t end_ns = 0;
  };
  /// If two solutions are farther apart, there is a pause between them.
  static constexpr uint64_t kLongestCycle_ns = 500'000'000;
  const std::vector<Pause>& pauses() const { return pauses_; }
  /// The name of an attachment that is damaged in the first file; nothing if none is.
  std::optional<std::string> damaged_attachment() const;
  /// The name of the file that has the message at this place.
  const std::string& file_of(const MessagePlace& place) const { return names_[place.file]; }
  /// The name of the first file.
  const std::string& name() const { return names_.front(); }

 private:
  /// Whether the file was added, perhaps by another name: the black box has links to files.
  bool has(const std::filesystem::path& file) const;
  Status add(const std::filesystem::path& path);
  /// Fails if a file is a copy of another one.
  Status check_once() const;
  Status add_messages(const mcap::Reader& reader, uint32_t file);
  void note_times();
  void note_pauses();
  void note_drops();
  double seconds_of(uint64_t log_time_ns) const;
  Result<std::string_view> bytes_of(const MessagePlace& place);

  std::vector<mcap::Reader> readers_;
  std::vector<std::string> names_;
  std::vector<std::string> cut_files_;
  std::vector<std::string> damages_;
  std::vector<Pause> pauses_;
  uint64_t images_not_recorded_ = 0;  ///< because the recorder was too slow, or refused them
  uint64_t events_not_recorded_ = 0;
  std::map<std::string, std::vector<MessagePlace>, std::less<>> topics_;
  std::map<std::string, std::string, std::less<>> schemas_;  ///< of each topic
  Duration offset_{};
  uint64_t begin_ns_ = 0;
  uint64_t end_ns_ = 0;
  struct Cached {
    uint32_t file = 0;
    uint32_t chunk = 0;
    mcap::Chunk content;
  };
  std::vector<Cached> cache_;  ///< newest last
};

}  // namespace bevloc::evaluation
