#include "common/mcap/reader.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <zstd.h>

#include "common/crc32.h"
#include "common/mcap/bytes.h"

namespace bevloc::mcap {
namespace {

/// The most bytes that a chunk may hold. A larger size is a damaged one.
constexpr uint64_t kMostChunkBytes = uint64_t{256} << 20U;

struct Record {
  Opcode opcode = Opcode::kHeader;
  std::string_view content;
  size_t end = 0;  ///< offset of the next record
};

/// Returns the record at `offset`, or nothing if it is not whole.
std::optional<Record> record_at(std::string_view bytes, uint64_t offset) {
  if (offset > bytes.size()) return std::nullopt;
  ByteReader reader(bytes.substr(offset));
  const auto opcode = static_cast<Opcode>(reader.number<uint8_t>());
  const auto length = reader.number<uint64_t>();
  const std::string_view content = reader.raw(length);
  if (!reader.ok()) return std::nullopt;
  return Record{opcode, content, bytes.size() - reader.rest().size()};
}

std::string_view view(const std::vector<char>& bytes) {
  return {bytes.data(), bytes.size()};
}

std::optional<Message> message_of(std::string_view content) {
  ByteReader reader(content);
  Message message;
  message.channel_id = reader.number<uint16_t>();
  message.sequence = reader.number<uint32_t>();
  message.log_time_ns = reader.number<uint64_t>();
  message.publish_time_ns = reader.number<uint64_t>();
  message.data = reader.rest();
  return reader.ok() ? std::optional(message) : std::nullopt;
}

template <typename T>
const T* find_named(const std::vector<T>& all, std::string_view name) {
  const auto found = std::ranges::find(all, name, &T::name);
  return found == all.end() ? nullptr : &*found;
}

}  // namespace

Result<Reader> Reader::open(const std::filesystem::path& path) {
  auto file = MappedFile::open(path, "an MCAP recording");
  if (!file) return tl::unexpected(file.error());
  Reader reader;
  reader.name_ = path.string();
  reader.file_ = std::make_shared<const MappedFile>(std::move(*file));
  reader.bytes_ = reader.file_->bytes();
  if (Status read = reader.read(); !read) return tl::unexpected(read.error());
  return reader;
}

Result<Reader> Reader::parse(std::string_view bytes, const std::string& name) {
  Reader reader;
  reader.name_ = name;
  reader.bytes_ = bytes;
  if (Status read = reader.read(); !read) return tl::unexpected(read.error());
  return reader;
}

Status Reader::read() {
  if (!bytes_.starts_with(kMagic)) {
    return fail("{}: found a file that does not begin as MCAP does, wanted a recording", name_);
  }
  read_beginning();
  complete_ = read_summary();
  if (!complete_) scan();
  return {};
}

/// Reads the records before the first chunk.
void Reader::read_beginning() {
  for (auto record = record_at(bytes_, kMagic.size()); record;
       record = record_at(bytes_, record->end)) {
    if (record->opcode == Opcode::kChunk) return;
    define(record->opcode, record->content);
  }
}

void Reader::define(Opcode opcode, std::string_view content) {
  ByteReader reader(content);
  if (opcode == Opcode::kSchema) {
    Schema schema;
    schema.id = reader.number<uint16_t>();
    schema.name = reader.text();
    schema.encoding = reader.text();
    schema.data = reader.text();
    if (reader.ok()) schemas_.try_emplace(schema.id, std::move(schema));
  } else if (opcode == Opcode::kChannel) {
    Channel channel;
    channel.id = reader.number<uint16_t>();
    channel.schema_id = reader.number<uint16_t>();
    channel.topic = reader.text();
    channel.message_encoding = reader.text();
    channel.metadata = reader.texts();
    if (reader.ok()) channels_.try_emplace(channel.id, std::move(channel));
  } else if (opcode == Opcode::kMetadata) {
    Metadata metadata;
    metadata.name = reader.text();
    metadata.values = reader.texts();
    if (reader.ok()) metadata_.push_back(std::move(metadata));
  } else if (opcode == Opcode::kAttachment) {
    Attachment attachment;
    attachment.log_time_ns = reader.number<uint64_t>();
    reader.number<uint64_t>();
    attachment.name = reader.text();
    attachment.media_type = reader.text();
    attachment.data = reader.raw(reader.number<uint64_t>());
    const size_t covered = content.size() - reader.rest().size();
    const auto checksum = reader.number<uint32_t>();
    const bool intact = checksum == 0 || checksum == crc32(content.substr(0, covered));
    if (!reader.ok()) return;
    if (intact) {
      attachments_.push_back(std::move(attachment));
    } else {
      damaged_attachments_.push_back(attachment.name);
    }
  }
}

/// Returns false if the summary is missing or damaged. Nothing was taken from it then.
bool Reader::read_summary() {
  if (bytes_.size() < kMagic.size() + kFooterBytes || !bytes_.ends_with(kMagic)) return false;
  const size_t footer = bytes_.size() - kMagic.size() - kFooterBytes;
  const auto record = record_at(bytes_, footer);
  if (!record || record->opcode != Opcode::kFooter || record->content.size() != 20) return false;
  ByteReader reader(record->content);
  const auto begin = reader.number<uint64_t>();
  reader.number<uint64_t>();
  const auto checksum = reader.number<uint32_t>();
  if (begin == 0 || begin > footer) return false;
  const std::string_view covered = bytes_.substr(begin, footer + kFooterBytes - 4 - begin);
  if (checksum != 0 && checksum != crc32(covered)) return false;
  for (auto part = record_at(bytes_, begin); part && part->end <= footer;
       part = record_at(bytes_, part->end)) {
    if (part->opcode == Opcode::kSchema || part->opcode == Opcode::kChannel) {
      define(part->opcode, part->content);
    } else if (part->opcode == Opcode::kChunkIndex) {
      ByteReader index(part->content);
      ChunkPlace place;
      place.first_ns = index.number<uint64_t>();
      place.last_ns = index.number<uint64_t>();
      place.offset = index.number<uint64_t>();
      if (index.ok()) chunks_.push_back(place);
    }
  }
  return true;
}

void Reader::scan() {
  chunks_.clear();
  for (auto record = record_at(bytes_, kMagic.size()); record;
       record = record_at(bytes_, record->end)) {
    if (record->opcode == Opcode::kDataEnd) return;
    if (record->opcode == Opcode::kSchema || record->opcode == Opcode::kChannel) {
      define(record->opcode, record->content);
    }
    if (record->opcode != Opcode::kChunk) continue;
    const uint64_t offset = record->end - kRecordHeadBytes - record->content.size();
    if (!place_chunk(record->content, offset)) return;
  }
}

/// After a power cut a file may have its length but not its content, so each chunk is unpacked.
bool Reader::place_chunk(std::string_view content, uint64_t offset) {
  const auto unpacked = unpack(content, offset);
  if (!unpacked) return false;
  ByteReader reader(content);
  ChunkPlace place;
  place.offset = offset;
  place.first_ns = reader.number<uint64_t>();
  place.last_ns = reader.number<uint64_t>();
  chunks_.push_back(place);
  for (auto record = record_at(view(*unpacked), 0); record;
       record = record_at(view(*unpacked), record->end)) {
    if (record->opcode != Opcode::kMessage) define(record->opcode, record->content);
  }
  return true;
}

Result<std::vector<char>> Reader::unpack(std::string_view content, uint64_t offset) const {
  ByteReader reader(content);
  reader.raw(16);
  const auto size = reader.number<uint64_t>();
  const auto checksum = reader.number<uint32_t>();
  const std::string_view compression = reader.text();
  const std::string_view packed = reader.raw(reader.number<uint64_t>());
  const auto refuse = [&](std::string_view found) {
    return fail("{}: offset {}: found {}, wanted a whole chunk", name_, offset, found);
  };
  if (!reader.ok()) return refuse("a chunk that ends early");
  if (size > kMostChunkBytes) return refuse(fmt::format("a chunk of {} bytes", size));
  std::vector<char> bytes;
  if (compression.empty()) {
    bytes.assign(packed.begin(), packed.end());
  } else if (compression == "zstd") {
    if (ZSTD_getFrameContentSize(packed.data(), packed.size()) != size) {
      return refuse("a chunk of another size than it says");
    }
    bytes.resize(size);
    const size_t got = ZSTD_decompress(bytes.data(), size, packed.data(), packed.size());
    if (ZSTD_isError(got) != 0U || got != size) return refuse("damaged compressed bytes");
  } else {
    return refuse(fmt::format("the compression '{}' and not zstd", compression));
  }
  if (bytes.size() != size || (checksum != 0 && checksum != crc32(view(bytes)))) {
    return refuse("bytes that do not fit their checksum");
  }
  return bytes;
}

Result<Chunk> Reader::read_chunk(size_t index) const {
  const uint64_t offset = chunks_[index].offset;
  const auto record = record_at(bytes_, offset);
  if (!record || record->opcode != Opcode::kChunk) {
    return fail("{}: offset {}: found no chunk, wanted the chunk that the index lists here", name_,
                offset);
  }
  auto unpacked = unpack(record->content, offset);
  if (!unpacked) return tl::unexpected(unpacked.error());
  Chunk chunk{std::move(*unpacked), {}};
  for (auto inner = record_at(view(chunk.bytes), 0); inner;
       inner = record_at(view(chunk.bytes), inner->end)) {
    if (inner->opcode != Opcode::kMessage) continue;
    if (const auto message = message_of(inner->content)) chunk.messages.push_back(*message);
  }
  return chunk;
}

const Attachment* Reader::attachment(std::string_view name) const {
  return find_named(attachments_, name);
}

const Metadata* Reader::metadata(std::string_view name) const {
  return find_named(metadata_, name);
}

}  // namespace bevloc::mcap
