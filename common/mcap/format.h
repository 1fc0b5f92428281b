// The MCAP file format (https://mcap.dev/spec): its records, and what writer and reader share.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace bevloc::mcap {

/// The first and the last bytes of a file.
inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};

/// The kind of a record. A record consists of one byte for its kind, eight bytes for its length,
/// and its content.
enum class Opcode : uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

inline constexpr size_t kRecordHeadBytes = 9;
/// The size of the last record: its head, two offsets and a checksum.
inline constexpr size_t kFooterBytes = kRecordHeadBytes + 8 + 8 + 4;

/// Describes the messages of a channel.
struct Schema {
  uint16_t id = 0;       ///< 0 stands for no schema
  std::string name;      ///< such as "foxglove.RawImage"
  std::string encoding;  ///< such as "protobuf"
  std::string data;      ///< a FileDescriptorSet for protobuf
};

/// A stream of messages of one schema.
struct Channel {
  uint16_t id = 0;
  uint16_t schema_id = 0;
  std::string topic;
  std::string message_encoding;
  std::map<std::string, std::string> metadata;
};

/// One message. It borrows its data.
struct Message {
  uint16_t channel_id = 0;
  uint32_t sequence = 0;
  uint64_t log_time_ns = 0;      ///< when it was recorded
  uint64_t publish_time_ns = 0;  ///< when it was made
  std::string_view data;
};

/// A whole file within the file.
struct Attachment {
  uint64_t log_time_ns = 0;
  std::string name;
  std::string media_type;
  std::string data;
};

/// Named texts.
struct Metadata {
  std::string name;
  std::map<std::string, std::string> values;
};

}  // namespace bevloc::mcap
