// Writes MCAP files that stay readable after a crash or a power cut.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/file_descriptor.h"
#include "common/mcap/format.h"
#include "common/result.h"

struct ZSTD_CCtx_s;

namespace bevloc::mcap {

/// Schemas, channels, metadata and attachments go to the file at once, messages in chunks
/// compressed with zstd. A file without its end lacks at most the last chunk, and Reader reads it.
/// After an error every call fails with the same error. One thread.
class Writer {
 public:
  /// Creates the file, which must not exist.
  static Result<std::unique_ptr<Writer>> create(const std::filesystem::path& path);
  ~Writer();

  /// Returns the id of the schema. `data` is a FileDescriptorSet of protobuf.
  Result<uint16_t> add_schema(std::string_view name, std::string_view data);
  /// Returns the id of the channel, whose messages are protobuf.
  Result<uint16_t> add_channel(uint16_t schema_id, std::string_view topic);
  Status add_metadata(const Metadata& metadata);
  Status add_attachment(const Attachment& attachment);

  /// `message.channel_id` must be an id that add_channel() returned.
  Status write(const Message& message);
  /// Writes the open chunk, and waits until the file is on the disk.
  Status flush();
  /// Writes the open chunk, the summary and the end. Nothing may be added afterwards.
  Status finish();

  uint64_t bytes_written() const { return offset_; }

 private:
  struct ChunkIndex {
    uint64_t first_ns = 0, last_ns = 0;
    uint64_t offset = 0, length = 0;
    std::map<uint16_t, uint64_t> index_offsets;
    uint64_t index_length = 0;
    uint64_t compressed_bytes = 0, bytes = 0;
  };
  struct IndexEntry {
    uint64_t log_time_ns = 0;
    uint64_t offset = 0;
  };

  Writer(FileDescriptor file, std::filesystem::path path);
  Status put(Opcode opcode, std::string_view content);
  Status put_bytes(std::string_view bytes);
  Status close_chunk();
  Status write_index(ChunkIndex& chunk);
  std::string summary();
  void append_indices(std::string& summary) const;
  std::string statistics() const;

  const FileDescriptor file_;
  const std::filesystem::path path_;
  ZSTD_CCtx_s* const compressor_;
  Status state_;
  uint64_t offset_ = 0;
  std::vector<std::string> schemas_;   ///< contents of the records, repeated in the summary
  std::vector<std::string> channels_;  ///< contents of the records, repeated in the summary
  std::vector<std::string> attachment_indices_;
  std::vector<std::string> metadata_indices_;
  std::vector<ChunkIndex> chunks_;
  std::map<uint16_t, uint64_t> message_counts_;
  uint64_t first_ns_ = 0, last_ns_ = 0;  ///< times of all messages
  // The open chunk.
  std::string records_;
  std::map<uint16_t, std::vector<IndexEntry>> entries_;
  uint64_t chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  std::string compressed_;
};

}  // namespace bevloc::mcap
