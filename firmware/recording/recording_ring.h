// The files of a recording: a ring that is bounded in size and age, and a black box.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>

#include "firmware/config/record_config.h"
#include "firmware/recording/recording_file.h"

namespace bevloc::firmware {

/// Checks whether open() could create its folders here. Changes nothing.
Status check_folder(const std::filesystem::path& directory);

/// Writes one file after the other into the folder, and deletes the oldest ones beyond the limits.
/// If the clock seems to be wrong, because all files of earlier runs would be too old by more than
/// a year, deletes no file because of its age. keep() gives the files of the last minute a second
/// name (a hard link) in the folder `kept`, which the ring does not delete. The file that is being
/// written can be kept too: it grows under both names. If the disk is full, deletes the oldest
/// files of the ring, and then those in `kept`. Deletes none if all of them together would not free
/// enough. A file ends before its time when it has a quarter of the bytes that the ring may have,
/// or that the disk has for it, so that the black box fits into the ring. One thread.
class RecordingRing {
 public:
  /// The time before an event that the black box covers.
  static constexpr Duration kBlackBox = std::chrono::seconds(60);

  /// The function std::filesystem::space(), or that of a test.
  using SpaceOf = std::filesystem::space_info (*)(const std::filesystem::path& path,
                                                  std::error_code& error);

  /// Creates the folders and the first file. Times are log times: nanoseconds since 1970.
  static Result<RecordingRing> open(const RecordConfig& config, RecordingHead head,
                                    uint64_t log_time_ns,
                                    SpaceOf space_of = std::filesystem::space);

  Status write(std::string_view topic, const google::protobuf::Message& message,
               uint64_t log_time_ns, uint64_t publish_time_ns);
  /// Begins the next file when it is due. Otherwise writes what is buffered to the disk.
  Status step(uint64_t log_time_ns);
  Status finish() { return file_->finish(); }

  /// Keeps the files of the last minute, and deletes the oldest other files in `kept` beyond
  /// `black_box_files`. Returns the name of the newest file that was kept.
  Result<std::filesystem::path> keep(uint64_t log_time_ns);

  uint64_t bytes_written() const { return bytes_of_closed_ + file_->bytes_written(); }
  const std::filesystem::path& file() const { return recent_.back().path; }

 private:
  struct RecentFile {
    std::filesystem::path path;
    uint64_t begin_ns = 0;
    uint64_t end_ns = 0;  ///< meaningless for the newest file
  };

  RecordingRing(const RecordConfig& config, RecordingHead head, uint64_t log_time_ns,
                SpaceOf space_of)
      : config_(config), head_(std::move(head)), space_of_(space_of), begin_ns_(log_time_ns) {}
  Status begin_file(uint64_t log_time_ns);
  /// Returns a name for a file of this time that no other file has, also none in `kept`. The names
  /// of a run are in the order of time and have the numbers from 1 on.
  std::filesystem::path next_name(uint64_t log_time_ns);
  /// Deletes the oldest files until the limits of the configuration are met. `newest` is never
  /// deleted, but counts if it exists.
  void delete_old(const std::filesystem::path& newest, uint64_t log_time_ns);
  void warn_of_the_clock();
  /// Deletes old files until enough of the disk is free. Fails without deleting any if all of them
  /// together would not free enough.
  Status make_room(const std::filesystem::path& newest) const;
  /// Returns how many bytes are missing of those that the ring leaves free on the disk.
  uint64_t missing_bytes() const;
  /// Returns how many bytes the recordings in both folders may have.
  uint64_t bytes_for_recordings(const std::filesystem::path& newest) const;

  RecordConfig config_;
  RecordingHead head_;
  SpaceOf space_of_;
  uint64_t begin_ns_;  ///< log time of the beginning of the run
  std::optional<RecordingFile> file_;
  std::deque<RecentFile> recent_;  ///< the files that overlap the last minute, oldest first
  int number_ = 0;
  uint64_t named_ns_ = 0;         ///< the log time in the name of the newest file
  uint64_t most_bytes_ = 0;       ///< with this size, file_ ends before its time
  uint64_t bytes_of_closed_ = 0;  ///< bytes of the files of this run before file_
  bool clock_warned_ = false;
};

}  // namespace bevloc::firmware
