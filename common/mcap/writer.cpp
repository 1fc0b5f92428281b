#include "common/mcap/writer.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>
#include <zstd.h>

#include "common/crc32.h"
#include "common/mcap/bytes.h"
#include "common/time.h"
#include "common/version.h"

namespace bevloc::mcap {
namespace {

// A chunk is written when its messages span this time or have this size. Messages that are not
// written yet are lost if the process dies.
constexpr Duration kChunkSpan = std::chrono::milliseconds(500);
constexpr size_t kChunk_bytes = size_t{4} << 20U;
constexpr int kZstdLevel = 1;
constexpr std::string_view kEncoding = "protobuf";  // of schemas and messages

void append_record(std::string& bytes, Opcode opcode, std::string_view content) {
  ByteWriter(bytes)
      .number(static_cast<uint8_t>(opcode))
      .number(static_cast<uint64_t>(content.size()))
      .raw(content);
}

}  // namespace

Result<std::unique_ptr<Writer>> Writer::create(const std::filesystem::path& path) {
  FileDescriptor file(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
  if (file.get() < 0) {
    return fail("{}: cannot create this file ({}), wanted a new recording", path.string(),
                std::strerror(errno));
  }
  auto writer = std::unique_ptr<Writer>(new Writer(std::move(file), path));
  std::string header;
  ByteWriter(header).text("").text(fmt::format("bevloc {}", version()));
  if (Status status = writer->put_bytes(kMagic); !status) return tl::unexpected(status.error());
  if (Status status = writer->put(Opcode::kHeader, header); !status) {
    return tl::unexpected(status.error());
  }
  return writer;
}

Writer::Writer(FileDescriptor file, std::filesystem::path path)
    : file_(std::move(file)), path_(std::move(path)), compressor_(ZSTD_createCCtx()) {
  records_.reserve(kChunk_bytes + kChunk_bytes / 4);
}

Writer::~Writer() {
  ZSTD_freeCCtx(compressor_);
}

Status Writer::put_bytes(std::string_view bytes) {
  while (state_ && !bytes.empty()) {
    const ssize_t written = ::write(file_.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      state_ = fail("{}: cannot write to this file ({}), wanted room and a healthy disk",
                    path_.string(), std::strerror(errno));
      break;
    }
    offset_ += static_cast<uint64_t>(written);
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return state_;
}

Status Writer::put(Opcode opcode, std::string_view content) {
  std::string head;
  ByteWriter(head)
      .number(static_cast<uint8_t>(opcode))
      .number(static_cast<uint64_t>(content.size()));
  (void)put_bytes(head);
  return put_bytes(content);
}

Result<uint16_t> Writer::add_schema(std::string_view name, std::string_view data) {
  const auto id = static_cast<uint16_t>(schemas_.size() + 1);
  std::string content;
  ByteWriter(content).number(id).text(name).text(kEncoding).text(data);
  schemas_.push_back(content);
  if (Status status = put(Opcode::kSchema, content); !status) return tl::unexpected(status.error());
  return id;
}

Result<uint16_t> Writer::add_channel(uint16_t schema_id, std::string_view topic) {
  const auto id = static_cast<uint16_t>(channels_.size() + 1);
  std::string content;
  ByteWriter(content).number(id).number(schema_id).text(topic).text(kEncoding).texts({});
  channels_.push_back(content);
  if (Status status = put(Opcode::kChannel, content); !status) {
    return tl::unexpected(status.error());
  }
  return id;
}

Status Writer::add_metadata(const Metadata& metadata) {
  std::string content;
  ByteWriter(content).text(metadata.name).texts(metadata.values);
  std::string index;
  ByteWriter(index)
      .number(offset_)
      .number(static_cast<uint64_t>(kRecordHeadBytes + content.size()))
      .text(metadata.name);
  metadata_indices_.push_back(index);
  return put(Opcode::kMetadata, content);
}

Status Writer::add_attachment(const Attachment& attachment) {
  std::string content;
  ByteWriter writer(content);
  writer.number(attachment.log_time_ns).number(attachment.log_time_ns);
  writer.text(attachment.name).text(attachment.media_type);
  writer.number(static_cast<uint64_t>(attachment.data.size())).raw(attachment.data);
  writer.number(crc32(content));
  std::string index;
  ByteWriter(index)
      .number(offset_)
      .number(static_cast<uint64_t>(kRecordHeadBytes + content.size()))
      .number(attachment.log_time_ns)
      .number(attachment.log_time_ns)
      .number(static_cast<uint64_t>(attachment.data.size()))
      .text(attachment.name)
      .text(attachment.media_type);
  attachment_indices_.push_back(index);
  return put(Opcode::kAttachment, content);
}

Status Writer::write(const Message& message) {
  const bool first = records_.empty();
  chunk_first_ns_ = first ? message.log_time_ns : std::min(chunk_first_ns_, message.log_time_ns);
  chunk_last_ns_ = first ? message.log_time_ns : std::max(chunk_last_ns_, message.log_time_ns);
  entries_[message.channel_id].push_back({message.log_time_ns, records_.size()});
  ByteWriter(records_)
      .number(static_cast<uint8_t>(Opcode::kMessage))
      .number(static_cast<uint64_t>(2 + 4 + 8 + 8 + message.data.size()))
      .number(message.channel_id)
      .number(message.sequence)
      .number(message.log_time_ns)
      .number(message.publish_time_ns)
      .raw(message.data);
  const Duration span(chunk_last_ns_ - chunk_first_ns_);
  if (span < kChunkSpan && records_.size() < kChunk_bytes) return state_;
  return close_chunk();
}

Status Writer::close_chunk() {
  if (records_.empty()) return state_;
  compressed_.resize(ZSTD_compressBound(records_.size()));
  const size_t bytes = ZSTD_compressCCtx(compressor_, compressed_.data(), compressed_.size(),
                                         records_.data(), records_.size(), kZstdLevel);
  if (ZSTD_isError(bytes) != 0U) {
    return state_ =
               fail("{}: cannot compress a chunk ({})", path_.string(), ZSTD_getErrorName(bytes));
  }
  compressed_.resize(bytes);
  ChunkIndex chunk{chunk_first_ns_, chunk_last_ns_, offset_, 0, {}, 0, bytes, records_.size()};
  std::string head;
  ByteWriter(head)
      .number(chunk_first_ns_)
      .number(chunk_last_ns_)
      .number(static_cast<uint64_t>(records_.size()))
      .number(crc32(records_))
      .text("zstd")
      .number(static_cast<uint64_t>(bytes));
  std::string record;
  ByteWriter(record)
      .number(static_cast<uint8_t>(Opcode::kChunk))
      .number(static_cast<uint64_t>(head.size() + bytes))
      .raw(head);
  (void)put_bytes(record);
  (void)put_bytes(compressed_);
  chunk.length = offset_ - chunk.offset;
  return write_index(chunk);
}

Status Writer::write_index(ChunkIndex& chunk) {
  const bool first_of_file = chunks_.empty();
  first_ns_ = first_of_file ? chunk.first_ns : std::min(first_ns_, chunk.first_ns);
  last_ns_ = first_of_file ? chunk.last_ns : std::max(last_ns_, chunk.last_ns);
  const uint64_t begin = offset_;
  for (auto& [channel, entries] : entries_) {
    if (entries.empty()) continue;
    chunk.index_offsets[channel] = offset_;
    message_counts_[channel] += entries.size();
    std::string content;
    ByteWriter writer(content);
    writer.number(channel).number(static_cast<uint32_t>(16 * entries.size()));
    for (const IndexEntry& entry : entries) writer.number(entry.log_time_ns).number(entry.offset);
    (void)put(Opcode::kMessageIndex, content);
    entries.clear();
  }
  chunk.index_length = offset_ - begin;
  chunks_.push_back(std::move(chunk));
  records_.clear();
  return state_;
}

Status Writer::flush() {
  if (Status closed = close_chunk(); !closed) return closed;
  if (fdatasync(file_.get()) != 0 && errno != EINVAL) {
    state_ = fail("{}: cannot write this file to the disk ({}), wanted a healthy disk",
                  path_.string(), std::strerror(errno));
  }
  return state_;
}

std::string Writer::statistics() const {
  uint64_t messages = 0;
  std::string counts;
  for (const auto& [channel, count] : message_counts_) {
    messages += count;
    ByteWriter(counts).number(channel).number(count);
  }
  std::string content;
  ByteWriter(content)
      .number(messages)
      .number(static_cast<uint16_t>(schemas_.size()))
      .number(static_cast<uint32_t>(channels_.size()))
      .number(static_cast<uint32_t>(attachment_indices_.size()))
      .number(static_cast<uint32_t>(metadata_indices_.size()))
      .number(static_cast<uint32_t>(chunks_.size()))
      .number(first_ns_)
      .number(last_ns_)
      .text(counts);
  return content;
}

void Writer::append_indices(std::string& summary) const {
  for (const ChunkIndex& chunk : chunks_) {
    std::string offsets;
    for (const auto& [channel, offset] : chunk.index_offsets) {
      ByteWriter(offsets).number(channel).number(offset);
    }
    std::string content;
    ByteWriter(content)
        .number(chunk.first_ns)
        .number(chunk.last_ns)
        .number(chunk.offset)
        .number(chunk.length)
        .text(offsets)
        .number(chunk.index_length)
        .text("zstd")
        .number(chunk.compressed_bytes)
        .number(chunk.bytes);
    append_record(summary, Opcode::kChunkIndex, content);
  }
}

/// Returns the records of the summary, then the places of its groups, then the footer.
std::string Writer::summary() {
  std::string bytes;
  std::string offsets;
  const auto group = [&](Opcode opcode, auto&& append) {
    const size_t begin = bytes.size();
    append();
    if (bytes.size() == begin) return;
    std::string content;
    ByteWriter(content)
        .number(static_cast<uint8_t>(opcode))
        .number(offset_ + begin)
        .number(static_cast<uint64_t>(bytes.size() - begin));
    append_record(offsets, Opcode::kSummaryOffset, content);
  };
  const auto all = [&](Opcode opcode, const std::vector<std::string>& contents) {
    group(opcode, [&] {
      for (const std::string& content : contents) append_record(bytes, opcode, content);
    });
  };
  all(Opcode::kSchema, schemas_);
  all(Opcode::kChannel, channels_);
  all(Opcode::kStatistics, {statistics()});
  group(Opcode::kChunkIndex, [&] { append_indices(bytes); });
  all(Opcode::kAttachmentIndex, attachment_indices_);
  all(Opcode::kMetadataIndex, metadata_indices_);
  const uint64_t offsets_begin = offset_ + bytes.size();
  bytes += offsets;
  ByteWriter writer(bytes);
  writer.number(static_cast<uint8_t>(Opcode::kFooter)).number(uint64_t{8 + 8 + 4});
  writer.number(offset_).number(offsets_begin);
  writer.number(crc32(bytes));
  return bytes;
}

Status Writer::finish() {
  if (Status closed = close_chunk(); !closed) return closed;
  std::string unknown_checksum;
  ByteWriter(unknown_checksum).number(uint32_t{0});
  (void)put(Opcode::kDataEnd, unknown_checksum);
  (void)put_bytes(summary());
  (void)put_bytes(kMagic);
  return flush();
}

}  // namespace bevloc::mcap
