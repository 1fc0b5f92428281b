// One file of a recording: an MCAP file with bevloc's topics and their schemas.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/mcap/writer.h"

namespace google::protobuf {
class Message;
}

namespace bevloc::firmware {

/// A message that each file of a recording begins with.
struct HeadMessage {
  std::string topic;
  std::shared_ptr<const google::protobuf::Message> message;
};

/// The data that each file of a recording begins with, so that each can be read on its own.
struct RecordingHead {
  std::map<std::string, std::string> metadata;
  std::vector<mcap::Attachment> attachments;
  std::vector<HeadMessage> messages;
};

/// A file, which makes the channel of a topic when its first message comes. One thread.
class RecordingFile {
 public:
  /// Creates the file and writes the head.
  static Result<RecordingFile> create(const std::filesystem::path& path, const RecordingHead& head,
                                      uint64_t log_time_ns);

  /// Every message of a topic must be of one type.
  Status write(std::string_view topic, const google::protobuf::Message& message,
               uint64_t log_time_ns, uint64_t publish_time_ns);
  Status flush() { return writer_->flush(); }
  Status finish() { return writer_->finish(); }
  uint64_t bytes_written() const { return writer_->bytes_written(); }

 private:
  struct Topic {
    uint16_t channel = 0;
    uint32_t count = 0;
  };

  explicit RecordingFile(std::unique_ptr<mcap::Writer> writer) : writer_(std::move(writer)) {}
  Result<Topic*> topic_of(std::string_view name, const google::protobuf::Message& message);

  std::unique_ptr<mcap::Writer> writer_;
  std::map<std::string, uint16_t> schemas_;  ///< ids of the schemas by full name of the message
  std::map<std::string, Topic, std::less<>> topics_;
  std::string bytes_;
};

}  // namespace bevloc::firmware
