#include "firmware/recording/recording_ring.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <iterator>
#include <map>
#include <vector>

#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include "common/writable_folder.h"
#include "firmware/recording/topics.h"

namespace bevloc::firmware {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "bevloc-";
constexpr uint64_t kLogSecond_ns = 1'000'000'000;
/// The ring leaves 1/kPartsOfDisk of the disk free for other files of the appliance, but not more
/// than kMostFree_bytes.
constexpr uint64_t kPartsOfDisk = 20;
constexpr uint64_t kMostFree_bytes = 1'000'000'000;
/// A file has at most this part of the bytes of all recordings.
constexpr uint64_t kPartsOfRecordings = 4;
/// If all files of earlier runs have exceeded their age by more than this, the clock is probably
/// wrong. No vehicle stands this long in its normal use, and the date of a GNSS receiver is often
/// wrong by a multiple of 1024 weeks.
constexpr uint64_t kImplausibleAge_ns = 365 * uint64_t{86'400} * kLogSecond_ns;

/// Returns a name such as bevloc-20261123T143205Z-0001.mcap. The order of the names is the order of
/// time.
std::string file_name(uint64_t log_time_ns, int number) {
  const auto seconds = static_cast<time_t>(log_time_ns / kLogSecond_ns);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  return fmt::format("{}{:04}{:02}{:02}T{:02}{:02}{:02}Z-{:04}.mcap", kPrefix, utc.tm_year + 1900,
                     utc.tm_mon + 1, utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec, number);
}

/// Reads the log time from such a name, which must begin with kPrefix. Returns 0 if no time
/// follows.
uint64_t log_time_in(const std::string& file_name) {
  std::tm utc{};
  int length = 0;
  std::sscanf(file_name.c_str() + kPrefix.size(), "%4d%2d%2dT%2d%2d%2dZ-%n", &utc.tm_year,
              &utc.tm_mon, &utc.tm_mday, &utc.tm_hour, &utc.tm_min, &utc.tm_sec, &length);
  utc.tm_year -= 1900;
  utc.tm_mon -= 1;
  const time_t seconds = timegm(&utc);
  if (length == 0 || seconds < 0) return 0;
  return static_cast<uint64_t>(seconds) * kLogSecond_ns;
}

/// Whether the daemon gave a file this name. A file that a user has renamed is not the ring's.
bool is_of_the_ring(const std::string& name) {
  if (!name.starts_with(kPrefix)) return false;
  int number = -1;
  int length = 0;
  std::sscanf(name.c_str() + kPrefix.size(), "%*8[0-9]T%*6[0-9]Z-%d.mcap%n", &number, &length);
  return number >= 0 && kPrefix.size() + static_cast<size_t>(length) == name.size();
}

struct Listed {
  fs::path path;
  uint64_t bytes = 0;
  uint64_t begin_ns = 0;   ///< log time in the name
  uint64_t latest_ns = 0;  ///< this time, or the time of the last change if that is later
  ino_t inode = 0;         ///< the same for all names (hard links) of a file
  nlink_t names = 0;       ///< how many names the file has
};

/// Returns nothing if the path is not a regular file or no longer exists.
std::optional<Listed> listed(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  const uint64_t begin_ns = log_time_in(path.filename().string());
  const auto changed_s = static_cast<uint64_t>(std::max<time_t>(0, status.st_mtim.tv_sec));
  const uint64_t latest_ns = std::max(begin_ns, changed_s * kLogSecond_ns);
  return Listed{path,          static_cast<uint64_t>(status.st_size),
                begin_ns,      latest_ns,
                status.st_ino, status.st_nlink};
}

/// Lists the recordings in the folder of `newest` in the order of deletion. Files with a later time
/// than `newest` come first, because the clock was wrong when they were written. The others follow,
/// oldest first, and `newest` is last.
std::vector<Listed> list_recordings(const fs::path& newest) {
  std::vector<Listed> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(newest.parent_path(), error)) {
    if (!is_of_the_ring(entry.path().filename().string())) continue;
    if (auto file = listed(entry.path())) files.push_back(std::move(*file));
  }
  std::ranges::sort(files, {}, &Listed::path);
  const auto later = std::ranges::upper_bound(files, newest, {}, &Listed::path);
  std::rotate(files.begin(), later, files.end());
  return files;
}

/// Lists what may be deleted so that `newest` can grow: the other files of the ring, and then those
/// of the black box.
std::vector<Listed> list_others(const fs::path& newest) {
  std::vector<Listed> files;
  const fs::path ring = newest.parent_path();
  for (const fs::path& folder : {ring, ring / kBlackBoxFolder}) {
    std::ranges::copy_if(
        list_recordings(folder / newest.filename()), std::back_inserter(files),
        [&](const Listed& file) { return file.path.filename() != newest.filename(); });
  }
  return files;
}

/// Returns how many bytes of the disk the ring leaves free.
uint64_t bytes_left_free(const fs::space_info& space) {
  return std::min(space.capacity / kPartsOfDisk, kMostFree_bytes);
}

/// Returns how many bytes become free when these files are deleted. A file with several names
/// counts once, and only if all its names are among them.
uint64_t bytes_to_free(const std::vector<Listed>& files) {
  std::map<ino_t, nlink_t> names;
  uint64_t bytes = 0;
  for (const Listed& file : files) {
    if (++names[file.inode] == file.names) bytes += file.bytes;
  }
  return bytes;
}

/// Returns whether the file is gone.
bool remove_file(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);
  if (error) spdlog::warn("recording: cannot delete {} ({})", path.string(), error.message());
  return !error;
}

tl::unexpected<Error> refuse_folder(const fs::path& directory, const std::string& reason) {
  return fail("{}: cannot create this folder ({}), wanted one for the recording",
              (directory / kBlackBoxFolder).string(), reason);
}

}  // namespace

Status check_folder(const fs::path& directory) {
  const std::error_code error = cannot_write_in(directory);
  return error ? refuse_folder(directory, error.message()) : Status{};
}

Result<RecordingRing> RecordingRing::open(const RecordConfig& config, RecordingHead head,
                                          uint64_t log_time_ns, SpaceOf space_of) {
  std::error_code error;
  fs::create_directories(config.directory / kBlackBoxFolder, error);
  if (error) return refuse_folder(config.directory, error.message());
  RecordingRing ring(config, std::move(head), log_time_ns, space_of);
  if (Status begun = ring.begin_file(log_time_ns); !begun) return tl::unexpected(begun.error());
  return ring;
}

Status RecordingRing::begin_file(uint64_t log_time_ns) {
  const fs::path path = next_name(log_time_ns);
  delete_old(path, log_time_ns);
  if (Status room = make_room(path); !room) return room;
  most_bytes_ = bytes_for_recordings(path) / kPartsOfRecordings;
  auto file = RecordingFile::create(path, head_, log_time_ns);
  if (!file) return tl::unexpected(file.error());
  if (file_) bytes_of_closed_ += file_->bytes_written();
  file_.emplace(std::move(*file));
  const auto covered = static_cast<uint64_t>(kBlackBox.count());
  std::erase_if(recent_, [&](const RecentFile& old) { return old.end_ns + covered < log_time_ns; });
  recent_.push_back({path, log_time_ns, 0});
  return {};
}

/// If the clock begins anew with each start, files of earlier runs may have the same time.
fs::path RecordingRing::next_name(uint64_t log_time_ns) {
  const auto is_taken = [this](const fs::path& name) {
    std::error_code ignored;
    return fs::exists(config_.directory / name, ignored) ||
           fs::exists(config_.directory / kBlackBoxFolder / name, ignored);
  };
  ++number_;
  named_ns_ = std::max(named_ns_, log_time_ns);
  while (is_taken(file_name(named_ns_, number_))) named_ns_ += kLogSecond_ns;
  return config_.directory / file_name(named_ns_, number_);
}

/// The age of a file counts from the later one of two times: the log time in its name, and the time
/// of its last change by the system clock. So a file does not become too old if the clock is set
/// after the file was begun.
void RecordingRing::delete_old(const fs::path& newest, uint64_t log_time_ns) {
  const std::vector<Listed> files = list_recordings(newest);
  uint64_t total = 0;
  uint64_t latest_ns = 0;  // the latest change of a file of an earlier run
  for (const Listed& file : files) {
    total += file.bytes;
    const bool of_earlier_run = file.begin_ns + kLogSecond_ns <= begin_ns_;
    if (of_earlier_run) latest_ns = std::max(latest_ns, file.latest_ns);
  }
  const auto longest = static_cast<uint64_t>(config_.max_age.count());
  const bool implausible = latest_ns > 0 && latest_ns + longest + kImplausibleAge_ns < log_time_ns;
  if (implausible) warn_of_the_clock();
  size_t deleted = 0;
  for (const Listed& file : files) {
    if (file.path == newest) break;
    const bool is_old = !implausible && file.latest_ns + longest < log_time_ns;
    if (total <= config_.max_bytes && !is_old) continue;
    const bool gone = remove_file(file.path);
    total -= file.bytes;
    if (is_old && gone) ++deleted;
  }
  if (deleted == 0) return;
  spdlog::info("recording: deleted {} files in {} that were older than record.max_age_h, {:g} h",
               deleted, config_.directory.string(), to_seconds(config_.max_age) / 3600.0);
}

void RecordingRing::warn_of_the_clock() {
  if (clock_warned_) return;
  clock_warned_ = true;
  spdlog::warn(
      "recording: the clock is probably wrong, because all earlier recordings in {} would be too "
      "old by more than a year; they are kept until the folder exceeds record.max_mb; check the "
      "clock",
      config_.directory.string());
}

uint64_t RecordingRing::missing_bytes() const {
  std::error_code error;
  const fs::space_info space = space_of_(config_.directory, error);
  if (error) return 0;
  const uint64_t wanted = bytes_left_free(space);
  return wanted - std::min(wanted, space.available);
}

uint64_t RecordingRing::bytes_for_recordings(const fs::path& newest) const {
  std::error_code error;
  const fs::space_info space = space_of_(config_.directory, error);
  if (error || space.capacity == 0) return config_.max_bytes;  // the disk does not tell
  const uint64_t bytes = space.available + bytes_to_free(list_others(newest));
  return std::min(config_.max_bytes, bytes - std::min(bytes, bytes_left_free(space)));
}

Status RecordingRing::make_room(const fs::path& newest) const {
  uint64_t missing = missing_bytes();
  if (missing == 0) return {};
  const std::vector<Listed> files = list_others(newest);
  if (bytes_to_free(files) >= missing) {
    for (size_t i = 0; i < files.size() && missing > 0; ++i) {
      remove_file(files[i].path);
      missing = missing_bytes();
    }
  }
  if (missing == 0) return {};
  return fail(
      "{}: found a full disk on which old recordings do not make enough room, wanted {:.0f} MB "
      "more; delete other files",
      config_.directory.string(), std::ceil(1e-6 * static_cast<double>(missing)));
}

Status RecordingRing::write(std::string_view topic, const google::protobuf::Message& message,
                            uint64_t log_time_ns, uint64_t publish_time_ns) {
  return file_->write(topic, message, log_time_ns, publish_time_ns);
}

Status RecordingRing::step(uint64_t log_time_ns) {
  const auto length = static_cast<uint64_t>(config_.file_length.count());
  RecentFile& newest = recent_.back();
  if (log_time_ns < newest.begin_ns + length && file_->bytes_written() < most_bytes_) {
    if (const Status room = make_room(newest.path); !room) return room;
    const Status flushed = file_->flush();
    delete_old(newest.path, log_time_ns);  // the file has grown
    return flushed;
  }
  newest.end_ns = log_time_ns;
  if (Status finished = file_->finish(); !finished) return finished;
  return begin_file(log_time_ns);
}

Result<fs::path> RecordingRing::keep(uint64_t log_time_ns) {
  const auto covered = static_cast<uint64_t>(kBlackBox.count());
  const fs::path folder = config_.directory / kBlackBoxFolder;
  std::error_code error;
  fs::create_directories(folder, error);  // somebody may have deleted it during the drive
  if (error) return refuse_folder(config_.directory, error.message());
  fs::path newest = folder / recent_.back().path.filename();
  fs::path oldest = newest;  // the oldest file of the last minute
  for (const RecentFile& file : recent_) {
    const bool is_newest = &file == &recent_.back();
    if (!is_newest && file.end_ns + covered < log_time_ns) continue;
    oldest = std::min(oldest, folder / file.path.filename());
    fs::create_hard_link(file.path, folder / file.path.filename(), error);
    // A ring that is shorter than the black box has deleted the oldest of these files.
    const bool was_deleted = error == std::errc::no_such_file_or_directory && !is_newest;
    if (error && error != std::errc::file_exists && !was_deleted) {
      return fail(
          "{}: cannot keep this file in {} ({}), wanted it on a file system with hard links",
          file.path.string(), folder.string(), error.message());
    }
  }
  const std::vector<Listed> kept = list_recordings(newest);
  const auto of_last_minute = std::ranges::count_if(
      kept, [&](const Listed& file) { return file.path >= oldest && file.path <= newest; });
  // These files are the last ones of the list, and none of them is deleted.
  const auto most =
      static_cast<size_t>(std::max<ptrdiff_t>(config_.black_box_files, of_last_minute));
  for (size_t i = 0; i + most < kept.size(); ++i) remove_file(kept[i].path);
  return newest;
}

}  // namespace bevloc::firmware
