#include "firmware/recording/recording_file.h"

#include <set>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/message.h>

#include "firmware/recording/topics.h"

namespace bevloc::firmware {
namespace {

namespace pb = google::protobuf;

/// Appends the file, and before it all files that it imports. Each file is appended once.
void add_file(const pb::FileDescriptor& file, std::set<std::string>& known,
              pb::FileDescriptorSet& files) {
  if (!known.insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) add_file(*file.dependency(i), known, files);
  file.CopyTo(files.add_file());
}

std::string descriptor_set_of(const pb::Message& message) {
  std::set<std::string> known;
  pb::FileDescriptorSet files;
  add_file(*message.GetDescriptor()->file(), known, files);
  return files.SerializeAsString();
}

}  // namespace

Result<RecordingFile> RecordingFile::create(const std::filesystem::path& path,
                                            const RecordingHead& head, uint64_t log_time_ns) {
  auto writer = mcap::Writer::create(path);
  if (!writer) return tl::unexpected(writer.error());
  RecordingFile file(std::move(*writer));
  Status status = file.writer_->add_metadata({std::string(kMetadataName), head.metadata});
  for (const mcap::Attachment& attachment : head.attachments) {
    if (status) status = file.writer_->add_attachment(attachment);
  }
  for (const HeadMessage& message : head.messages) {
    if (status) status = file.write(message.topic, *message.message, log_time_ns, log_time_ns);
  }
  if (!status) return tl::unexpected(status.error());
  return file;
}

Result<RecordingFile::Topic*> RecordingFile::topic_of(std::string_view name,
                                                      const pb::Message& message) {
  if (const auto known = topics_.find(name); known != topics_.end()) return &known->second;
  const std::string& type = message.GetDescriptor()->full_name();
  if (!schemas_.contains(type)) {
    const auto schema = writer_->add_schema(type, descriptor_set_of(message));
    if (!schema) return tl::unexpected(schema.error());
    schemas_.emplace(type, *schema);
  }
  const auto channel = writer_->add_channel(schemas_.at(type), name);
  if (!channel) return tl::unexpected(channel.error());
  return &topics_.emplace(name, Topic{*channel, 0}).first->second;
}

Status RecordingFile::write(std::string_view topic, const pb::Message& message,
                            uint64_t log_time_ns, uint64_t publish_time_ns) {
  const auto known = topic_of(topic, message);
  if (!known) return tl::unexpected(known.error());
  message.SerializeToString(&bytes_);
  return writer_->write(
      {(*known)->channel, (*known)->count++, log_time_ns, publish_time_ns, bytes_});
}

}  // namespace bevloc::firmware
