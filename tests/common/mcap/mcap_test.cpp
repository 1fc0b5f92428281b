// Recordings: what is written is read, a file cut anywhere loses at most its last second, and
// damage is found.
#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "common/files.h"
#include "common/mcap/reader.h"
#include "common/mcap/writer.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::mcap {
namespace {

constexpr uint64_t kStart_ns = 1'700'000'000'000'000'000;

/// A message as it was written, with the size of the file just after that.
struct Written {
  uint32_t sequence = 0;
  uint64_t log_time_ns = 0;
  std::string data;
  uint64_t file_bytes = 0;
};

class McapTest : public testing::Test {
 protected:
  void SetUp() override {
    path_ = folder_ / "drive.mcap";
    auto writer = Writer::create(path_);
    ASSERT_TRUE(writer) << writer.error().message;
    writer_ = std::move(*writer);
    const auto schema = writer_->add_schema("bevloc.Test", "a descriptor");
    ASSERT_TRUE(schema);
    frames_ = writer_->add_channel(*schema, "/can/in").value();
    images_ = writer_->add_channel(*schema, "/camera/front").value();
    ASSERT_TRUE(writer_->add_metadata({"bevloc", {{"model", "nano"}, {"map", "town"}}}));
    ASSERT_TRUE(writer_->add_attachment({7, "rig.yaml", "application/yaml", "cameras: {}\n"}));
  }

  /// A hundred small messages a second and ten that hardly compress.
  void drive(double seconds) {
    for (int cycle = 0; cycle < static_cast<int>(100.0 * seconds); ++cycle) {
      write(frames_, cycle, "frame " + std::to_string(cycle));
      if (cycle % 10 == 0) write(images_, cycle, noise(500));
    }
  }

  void write(uint16_t channel, int cycle, std::string data) {
    const uint64_t time_ns = kStart_ns + static_cast<uint64_t>(cycle) * 10'000'000U;
    const auto sequence = static_cast<uint32_t>(written_.size());
    ASSERT_TRUE(writer_->write({channel, sequence, time_ns, time_ns - 1, data}));
    written_.push_back({sequence, time_ns, std::move(data), writer_->bytes_written()});
  }

  std::string noise(size_t bytes) {
    std::string data(bytes, '\0');
    for (char& byte : data) byte = static_cast<char>(random_());
    return data;
  }

  std::string bytes() const { return read_file(path_).value(); }

  static std::vector<Written> read_all(const Reader& reader) {
    std::vector<Written> messages;
    for (size_t i = 0; i < reader.chunks().size(); ++i) {
      const auto chunk = reader.read_chunk(i);
      EXPECT_TRUE(chunk) << chunk.error().message;
      if (!chunk) break;
      for (const Message& message : chunk->messages) {
        messages.push_back({message.sequence, message.log_time_ns, std::string(message.data), 0});
      }
    }
    return messages;
  }

  /// The messages that were read are the first ones that were written.
  void expect_beginning(const std::vector<Written>& read) const {
    ASSERT_LE(read.size(), written_.size());
    for (size_t i = 0; i < read.size(); ++i) {
      ASSERT_EQ(read[i].sequence, written_[i].sequence);
      ASSERT_EQ(read[i].log_time_ns, written_[i].log_time_ns);
      ASSERT_EQ(read[i].data, written_[i].data);
    }
  }

  const test::TemporaryFolder folder_;
  std::filesystem::path path_;
  std::unique_ptr<Writer> writer_;
  uint16_t frames_ = 0;
  uint16_t images_ = 0;
  std::vector<Written> written_;
  std::mt19937 random_{18};
};

TEST_F(McapTest, ReadsWhatWasWritten) {
  drive(3.0);
  ASSERT_TRUE(writer_->finish());
  const auto reader = Reader::open(path_);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_TRUE(reader->complete());
  const auto read = read_all(*reader);
  EXPECT_EQ(read.size(), written_.size());
  expect_beginning(read);
  ASSERT_EQ(reader->schemas().size(), 1U);
  EXPECT_EQ(reader->schemas().begin()->second.name, "bevloc.Test");
  EXPECT_EQ(reader->channels().at(images_).topic, "/camera/front");
  ASSERT_NE(reader->metadata("bevloc"), nullptr);
  EXPECT_EQ(reader->metadata("bevloc")->values.at("map"), "town");
  ASSERT_NE(reader->attachment("rig.yaml"), nullptr);
  EXPECT_EQ(reader->attachment("rig.yaml")->data, "cameras: {}\n");
  EXPECT_EQ(reader->attachment("no such"), nullptr);
}

TEST_F(McapTest, ACutAnywhereLosesAtMostTheLastSecond) {
  drive(8.0);
  ASSERT_TRUE(writer_->finish());
  const std::string whole = bytes();
  constexpr int kCuts = 1000;
  int without_end = 0;
  for (int cut = 0; cut < kCuts; ++cut) {
    const size_t least = kMagic.size();
    const size_t length = least + (whole.size() - least) * static_cast<size_t>(cut) / kCuts;
    const std::string_view left = std::string_view(whole).substr(0, length);
    const auto reader = Reader::parse(left, "cut");
    ASSERT_TRUE(reader) << reader.error().message;
    without_end += reader->complete() ? 0 : 1;
    const auto read = read_all(*reader);
    expect_beginning(read);
    // What the writer had got when the file was this long.
    const auto behind = std::ranges::find_if(
        written_, [&](const Written& message) { return message.file_bytes > length; });
    if (behind == written_.begin()) continue;
    const uint64_t newest_ns = std::prev(behind)->log_time_ns;
    const uint64_t kept_ns = read.empty() ? kStart_ns : read.back().log_time_ns;
    ASSERT_LE(newest_ns, kept_ns + 1'000'000'000U) << "cut at byte " << length;
  }
  EXPECT_EQ(without_end, kCuts);
}

TEST_F(McapTest, ZerosAfterAPowerCutEndTheFile) {
  drive(5.0);
  ASSERT_TRUE(writer_->flush());
  std::string file = bytes();
  const auto all = Reader::parse(file, "whole");
  ASSERT_TRUE(all);
  ASSERT_GT(all->chunks().size(), 3U);
  std::fill(file.begin() + static_cast<ptrdiff_t>(all->chunks()[2].offset + 60), file.end(), '\0');
  const auto reader = Reader::parse(file, "zeros");
  ASSERT_TRUE(reader);
  EXPECT_FALSE(reader->complete());
  EXPECT_EQ(reader->chunks().size(), 2U);
  expect_beginning(read_all(*reader));
}

TEST_F(McapTest, ADamagedSummaryIsNotUsed) {
  drive(2.0);
  ASSERT_TRUE(writer_->finish());
  std::string file = bytes();
  file[file.size() - 60] = static_cast<char>(file[file.size() - 60] ^ 0x10);
  const auto reader = Reader::parse(file, "damaged");
  ASSERT_TRUE(reader);
  EXPECT_FALSE(reader->complete());
  EXPECT_EQ(read_all(*reader).size(), written_.size());
}

TEST_F(McapTest, ADamagedChunkIsRefusedByItsOffset) {
  drive(2.0);
  ASSERT_TRUE(writer_->finish());
  std::string file = bytes();
  const auto whole = Reader::parse(file, "whole");
  ASSERT_TRUE(whole);
  const uint64_t offset = whole->chunks()[1].offset;
  file[offset + 200] = static_cast<char>(file[offset + 200] ^ 1);
  const auto reader = Reader::parse(file, "damaged");
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->read_chunk(0));
  const auto chunk = reader->read_chunk(1);
  ASSERT_FALSE(chunk);
  EXPECT_NE(chunk.error().message.find(fmt::format("damaged: offset {}: found", offset)),
            std::string::npos)
      << chunk.error().message;
}

TEST_F(McapTest, RefusesOtherFilesAndKeepsExistingOnes) {
  EXPECT_FALSE(Reader::open(folder_ / "missing.mcap"));
  EXPECT_FALSE(Reader::open(folder_.path()));
  ASSERT_TRUE(write_file(folder_ / "text.mcap", "(0000000000.000000) can0 321#00\n"));
  const auto text = Reader::open(folder_ / "text.mcap");
  ASSERT_FALSE(text);
  EXPECT_NE(text.error().message.find("text.mcap: found a file that does not begin as MCAP"),
            std::string::npos);
  EXPECT_FALSE(Writer::create(path_));
}

}  // namespace
}  // namespace bevloc::mcap
