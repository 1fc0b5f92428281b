// Reads MCAP files, also those that a crash or a power cut has left without their end.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/mapped_file.h"
#include "common/mcap/format.h"
#include "common/result.h"

namespace bevloc::mcap {

/// Where a chunk lies in the file, and the times of its messages.
struct ChunkPlace {
  uint64_t offset = 0;  ///< where its record begins
  uint64_t first_ns = 0;
  uint64_t last_ns = 0;
};

/// The messages of one chunk, in the order of the file. They borrow from `bytes`.
struct Chunk {
  std::vector<char> bytes;
  std::vector<Message> messages;
};

/// A file whose messages lie in chunks that are not compressed, or compressed with zstd. The
/// summary of the file says where the chunks are. If the summary is missing or damaged, the reader
/// scans the file up to the first record that is not whole, or the first damaged chunk.
/// Thread-safe, because nothing changes after open().
class Reader {
 public:
  /// Maps the file into memory. Fails if it is no MCAP file. The file may grow meanwhile, but must
  /// not become shorter.
  static Result<Reader> open(const std::filesystem::path& path);
  /// Like open(), but reads bytes in memory, which must outlive the reader. Error messages show
  /// `name`.
  static Result<Reader> parse(std::string_view bytes, const std::string& name);

  /// Whether the file has its end. Without it the last second may be missing.
  bool complete() const { return complete_; }
  const std::map<uint16_t, Schema>& schemas() const { return schemas_; }
  const std::map<uint16_t, Channel>& channels() const { return channels_; }
  const std::vector<ChunkPlace>& chunks() const { return chunks_; }
  /// The attachments before the first chunk. Later ones are not read.
  const std::vector<Attachment>& attachments() const { return attachments_; }
  /// Names of the attachments that were left out because their checksum is wrong.
  const std::vector<std::string>& damaged_attachments() const { return damaged_attachments_; }
  const std::vector<Metadata>& metadata() const { return metadata_; }

  /// Fails if the chunk is damaged, or compressed with anything but zstd.
  Result<Chunk> read_chunk(size_t index) const;

  /// Return the first attachment or metadata of this name, or null if there is none.
  const Attachment* attachment(std::string_view name) const;
  const Metadata* metadata(std::string_view name) const;

 private:
  Status read();
  bool read_summary();
  void read_beginning();
  void scan();
  void define(Opcode opcode, std::string_view content);
  bool place_chunk(std::string_view content, uint64_t offset);
  Result<std::vector<char>> unpack(std::string_view content, uint64_t offset) const;

  std::string name_;
  std::shared_ptr<const MappedFile> file_;  ///< null for bytes in memory
  std::string_view bytes_;
  bool complete_ = false;
  std::map<uint16_t, Schema> schemas_;
  std::map<uint16_t, Channel> channels_;
  std::vector<ChunkPlace> chunks_;
  std::vector<Attachment> attachments_;
  std::vector<std::string> damaged_attachments_;
  std::vector<Metadata> metadata_;
};

}  // namespace bevloc::mcap
