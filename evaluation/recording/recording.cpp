#include "evaluation/recording/recording.h"

#include <algorithm>
#include <charconv>
#include <set>

#include <fmt/ranges.h>

#include "firmware/recording/topics.h"

namespace bevloc::evaluation {
namespace {

constexpr size_t kCachedChunks = 8;

/// Topics that a run writes while it goes on, in contrast to the head of each file.
bool is_of_the_run(std::string_view topic) {
  return topic != firmware::kMapTopic && !topic.ends_with("/calibration");
}

tl::unexpected<Error> refuse_short(const std::filesystem::path& path, uintmax_t bytes) {
  return fail(
      "{}: found {} bytes without the head of a recording, wanted a recording of bevloc; "
      "was it cut off?",
      path.string(), bytes);
}

/// Returns log time minus the appliance's clock, which is another one in each run. Returns nothing
/// if the file is no recording of bevloc.
std::optional<Duration> clock_offset_of(const mcap::Reader& reader) {
  const mcap::Metadata* metadata = reader.metadata(firmware::kMetadataName);
  if (metadata == nullptr) return std::nullopt;
  const auto text = metadata->values.find(std::string(firmware::kClockOffsetKey));
  if (text == metadata->values.end()) return std::nullopt;
  int64_t offset_ns = 0;
  const std::string& digits = text->second;
  std::from_chars(digits.data(), digits.data() + digits.size(), offset_ns);
  return Duration(offset_ns);
}

/// Names the files of a run in the folder of one of them.
std::string files_of_run(const std::filesystem::path& one, Duration offset) {
  std::set<std::string> names;
  std::error_code unreadable;
  const std::filesystem::path folder = one.has_parent_path() ? one.parent_path() : ".";
  for (const auto& entry : std::filesystem::directory_iterator(folder, unreadable)) {
    std::error_code ignored;
    if (!entry.is_regular_file(ignored)) continue;
    const auto reader = mcap::Reader::open(entry.path());
    if (reader && clock_offset_of(*reader) == offset) names.insert(entry.path().string());
  }
  return fmt::format("{}", fmt::join(names, " "));
}

}  // namespace

Result<Recording> Recording::open(const std::vector<std::filesystem::path>& files) {
  Recording recording;
  for (const auto& file : files) {
    if (recording.has(file)) continue;
    if (Status added = recording.add(file); !added) return tl::unexpected(added.error());
  }
  for (auto& [topic, places] : recording.topics_) {
    std::ranges::stable_sort(places, {}, &MessagePlace::log_time_ns);
  }
  if (Status once = recording.check_once(); !once) return tl::unexpected(once.error());
  recording.note_times();
  recording.note_pauses();
  recording.note_drops();
  return recording;
}

bool Recording::has(const std::filesystem::path& file) const {
  return std::ranges::any_of(names_, [&](const std::string& name) {
    std::error_code unreadable;
    return std::filesystem::equivalent(name, file, unreadable);
  });
}

Status Recording::check_once() const {
  const std::vector<MessagePlace>& solutions = messages(firmware::kSolutionTopic);
  const auto twice =
      std::ranges::adjacent_find(solutions, [](const MessagePlace& a, const MessagePlace& b) {
        return a.log_time_ns == b.log_time_ns && a.file != b.file;
      });
  if (twice == solutions.end()) return {};
  return fail("{}: found the same messages as in {}, wanted each file of the run once",
              names_[std::next(twice)->file], names_[twice->file]);
}

Status Recording::add(const std::filesystem::path& path) {
  std::error_code unreadable;
  const uintmax_t size = std::filesystem::file_size(path, unreadable);
  if (!unreadable && size < mcap::kMagic.size()) return refuse_short(path, size);
  auto reader = mcap::Reader::open(path);
  if (!reader) return tl::unexpected(reader.error());
  if (!reader->complete() && reader->metadata().empty() && reader->chunks().empty()) {
    return refuse_short(path, size);
  }
  const std::optional<Duration> offset = clock_offset_of(*reader);
  if (!offset) {
    return fail("{}: found an MCAP file of another program, wanted a recording of bevloc",
                path.string());
  }
  if (!readers_.empty() && *offset != offset_) {
    return fail("{}: found a file of another run than {}, wanted files of one run, such as {}",
                path.string(), names_.front(), files_of_run(names_.front(), offset_));
  }
  offset_ = *offset;
  const auto file = static_cast<uint32_t>(readers_.size());
  if (Status added = add_messages(*reader, file); !added) {
    damages_.push_back(added.error().message + "; the rest of the file is left out");
  }
  for (const std::string& name : reader->damaged_attachments()) {
    damages_.push_back(
        fmt::format("{}: found a damaged attachment {}, which is left out", path.string(), name));
  }
  if (!reader->complete()) cut_files_.push_back(path.string());
  readers_.push_back(std::move(*reader));
  names_.push_back(path.string());
  return {};
}

/// Fails at the first damaged chunk.
Status Recording::add_messages(const mcap::Reader& reader, uint32_t file) {
  for (uint32_t i = 0; i < reader.chunks().size(); ++i) {
    const auto chunk = reader.read_chunk(i);
    if (!chunk) return tl::unexpected(chunk.error());
    for (uint32_t index = 0; index < chunk->messages.size(); ++index) {
      const mcap::Message& message = chunk->messages[index];
      const auto channel = reader.channels().find(message.channel_id);
      if (channel == reader.channels().end()) continue;
      topics_[channel->second.topic].push_back(
          {message.log_time_ns, message.publish_time_ns, file, i, index});
      const auto schema = reader.schemas().find(channel->second.schema_id);
      if (schema != reader.schemas().end()) {
        schemas_[channel->second.topic] = schema->second.name;
      }
    }
  }
  return {};
}

std::vector<std::string> Recording::gaps() const {
  std::vector<std::string> sentences = damages_;
  for (const std::string& cut : cut_files_) {
    sentences.push_back(cut + ": has no end (crash, power cut or damage); reads what is there");
  }
  for (const Pause& pause : pauses_) {
    sentences.push_back(fmt::format(
        "{}: nothing is recorded from {:.1f} to {:.1f} s after the beginning; a file of "
        "the run is missing or damaged, or the daemon stood still",
        name(), seconds_of(pause.begin_ns), seconds_of(pause.end_ns)));
  }
  if (images_not_recorded_ + events_not_recorded_ > 0) {
    sentences.push_back(
        fmt::format("{}: {} images and {} events were not recorded; the replay differs", name(),
                    images_not_recorded_, events_not_recorded_));
  }
  return sentences;
}

double Recording::seconds_of(uint64_t log_time_ns) const {
  return static_cast<double>(static_cast<int64_t>(log_time_ns - begin_ns_)) / 1e9;
}

/// Notes the times without solutions. The daemon records a solution every 10 ms.
void Recording::note_pauses() {
  const auto& solutions = messages(firmware::kSolutionTopic);
  for (size_t i = 1; i < solutions.size(); ++i) {
    const uint64_t before_ns = solutions[i - 1].log_time_ns;
    const uint64_t now_ns = solutions[i].log_time_ns;
    if (now_ns - before_ns > kLongestCycle_ns) pauses_.push_back({before_ns, now_ns});
  }
}

/// Notes what the recorder could not record until its last count.
void Recording::note_drops() {
  const auto& counts = messages(firmware::kCountersTopic);
  if (counts.empty()) return;
  const auto last = read<bevloc::recording::Counters>(counts.back());
  if (!last) return damages_.push_back(last.error().message);
  images_not_recorded_ = last->images_not_recorded();
  events_not_recorded_ = last->events_not_recorded();
}

void Recording::note_times() {
  for (const auto& [topic, places] : topics_) {
    if (places.empty() || !is_of_the_run(topic)) continue;
    begin_ns_ = begin_ns_ == 0 ? places.front().log_time_ns
                               : std::min(begin_ns_, places.front().log_time_ns);
    end_ns_ = std::max(end_ns_, places.back().log_time_ns);
  }
}

const std::vector<MessagePlace>& Recording::messages(std::string_view topic) const {
  static const std::vector<MessagePlace> kNone;
  const auto found = topics_.find(topic);
  return found == topics_.end() ? kNone : found->second;
}

bool Recording::has_schema(std::string_view topic, std::string_view schema) const {
  const auto found = schemas_.find(topic);
  return found != schemas_.end() && found->second == schema;
}

std::string Recording::value(std::string_view key) const {
  const auto& values = readers_.front().metadata(firmware::kMetadataName)->values;
  const auto found = values.find(std::string(key));
  return found == values.end() ? "" : found->second;
}

std::optional<std::string> Recording::damaged_attachment() const {
  const auto& damaged = readers_.front().damaged_attachments();
  return damaged.empty() ? std::nullopt : std::optional(damaged.front());
}

const mcap::Attachment* Recording::attachment(std::string_view name) const {
  return readers_.front().attachment(name);
}

Result<std::string_view> Recording::bytes_of(const MessagePlace& place) {
  auto cached = std::ranges::find_if(cache_, [&](const Cached& known) {
    return known.file == place.file && known.chunk == place.chunk;
  });
  if (cached == cache_.end()) {
    auto chunk = readers_[place.file].read_chunk(place.chunk);
    if (!chunk) return tl::unexpected(chunk.error());
    if (cache_.size() == kCachedChunks) cache_.erase(cache_.begin());
    cache_.push_back({place.file, place.chunk, std::move(*chunk)});
    cached = std::prev(cache_.end());
  }
  return cached->content.messages[place.index].data;
}

Result<std::optional<HdMap>> Recording::map() {
  const auto& places = messages(firmware::kMapTopic);
  if (places.empty()) return std::optional<HdMap>();
  const auto message = read<bevloc::recording::Map>(places.front());
  if (!message) return tl::unexpected(message.error());
  return firmware::map_of(*message);
}

}  // namespace bevloc::evaluation
