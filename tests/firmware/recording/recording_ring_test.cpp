// The ring of recordings on a disk that is full, and the names of its files.
#include "firmware/recording/recording_ring.h"

#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "firmware/recording/messages.h"
#include "firmware/recording/topics.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::firmware {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kCapacity = 1'000'000;
constexpr uint64_t kLeftFree = kCapacity / 20;
constexpr uint64_t kSecond_ns = 1'000'000'000;
/// 2040-03-01.
constexpr uint64_t kNow_ns = 2'214'172'800 * kSecond_ns;

class FullDiskTest : public testing::Test {
 protected:
  FullDiskTest() {
    config_.directory = folder_ / "ring";
    fs::create_directories(config_.directory / "kept");
    other_bytes = 0;
    tells_size = true;
  }

  static fs::space_info space(const fs::path& folder, std::error_code& /*error*/) {
    if (!tells_size) return {0, 0, 0};
    uint64_t used = other_bytes;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) used += entry.file_size() / entry.hard_link_count();
    }
    return {kCapacity, kCapacity - used, kCapacity - used};
  }
  uint64_t free_bytes() const {
    std::error_code error;
    return space(config_.directory, error).available;
  }

  /// A file of an earlier day of February.
  fs::path leave(const std::string& folder, int day, size_t bytes) const {
    const std::string name = fmt::format("bevloc-204002{:02}T000000Z-0001.mcap", day);
    const fs::path path = config_.directory / folder / name;
    std::ofstream(path) << std::string(bytes, 'x');
    return path;
  }

  Result<RecordingRing> open() { return RecordingRing::open(config_, {}, kNow_ns, space); }

  /// Writes an image of 20,000 bytes, which cannot be compressed, ten times a second.
  static Status drive(RecordingRing& ring, int images) {
    std::minstd_rand random(1);
    std::string pixels(20'000, 0);
    std::ranges::generate(pixels, [&] { return static_cast<char>(random() >> 8U); });
    foxglove::CompressedImage image;
    image.set_data(pixels);
    for (int i = 1; i <= images; ++i) {
      const uint64_t now_ns = kNow_ns + static_cast<uint64_t>(i) * kSecond_ns / 10;
      Status written = ring.write(image_topic(0), image, now_ns, now_ns);
      if (written) written = ring.step(now_ns);
      if (!written) return written;
    }
    return {};
  }
  size_t files_in_ring() const {
    return static_cast<size_t>(std::ranges::count_if(
        fs::directory_iterator(config_.directory),
        [](const fs::directory_entry& entry) { return entry.is_regular_file(); }));
  }

  static uint64_t other_bytes;
  static bool tells_size;
  const test::TemporaryFolder folder_;
  RecordConfig config_;
};

uint64_t FullDiskTest::other_bytes = 0;
bool FullDiskTest::tells_size = true;

TEST_F(FullDiskTest, TheOldestFilesMakeRoomForANewRecording) {
  std::vector<fs::path> files;
  for (int day = 23; day < 29; ++day) files.push_back(leave("", day, 166'000));
  ASSERT_LT(free_bytes(), 5'000U);
  const auto ring = open();
  ASSERT_TRUE(ring) << ring.error().message;
  EXPECT_GE(free_bytes(), kLeftFree);
  EXPECT_FALSE(fs::exists(files[0]));
  for (size_t i = 1; i < files.size(); ++i) EXPECT_TRUE(fs::exists(files[i])) << files[i];
}

TEST_F(FullDiskTest, TheBlackBoxMakesRoomIfNothingElseCan) {
  const fs::path in_ring = leave("", 28, 10'000);
  const fs::path oldest = leave("kept", 1, 490'000);
  const fs::path newest = leave("kept", 2, 490'000);
  const auto ring = open();
  ASSERT_TRUE(ring) << ring.error().message;
  EXPECT_FALSE(fs::exists(in_ring));
  EXPECT_FALSE(fs::exists(oldest));
  EXPECT_TRUE(fs::exists(newest));
}

TEST_F(FullDiskTest, ADiskThatOtherFilesFillIsRefused) {
  other_bytes = 970'000;
  const auto ring = open();
  ASSERT_FALSE(ring);
  EXPECT_TRUE(ring.error().message.ends_with(
      ": found a full disk on which old recordings do not make enough room, wanted 1 MB more; "
      "delete other files"))
      << ring.error().message;
}

TEST_F(FullDiskTest, DeletesNothingIfThatWouldNotFreeEnough) {
  const fs::path kept = leave("kept", 1, 10'000);
  const fs::path in_ring = leave("", 28, 10'000);
  other_bytes = 970'000;  // 40'000 bytes are missing
  EXPECT_FALSE(open());
  EXPECT_TRUE(fs::exists(kept));
  EXPECT_TRUE(fs::exists(in_ring));
}

TEST_F(FullDiskTest, AFileWithTwoNamesFreesItsBytesOnce) {
  const fs::path in_ring = leave("", 28, 20'000);
  const fs::path kept = config_.directory / "kept" / in_ring.filename();
  fs::create_hard_link(in_ring, kept);
  other_bytes = 960'000;  // 30'000 bytes are missing
  EXPECT_FALSE(open());
  EXPECT_TRUE(fs::exists(in_ring));
  EXPECT_TRUE(fs::exists(kept));
  other_bytes = 945'000;  // 15'000 bytes are missing
  EXPECT_TRUE(open());
  EXPECT_FALSE(fs::exists(in_ring));
  EXPECT_FALSE(fs::exists(kept));
}

TEST_F(FullDiskTest, AFileThatHasAnotherNameElsewhereFreesNothing) {
  const fs::path in_ring = leave("", 28, 100'000);
  fs::create_hard_link(in_ring, folder_ / "copy");
  other_bytes = 960'000 - 50'000;  // 10'000 bytes are missing; space() counts half of the file
  ASSERT_EQ(free_bytes(), 40'000U);
  EXPECT_FALSE(open());
  EXPECT_TRUE(fs::exists(in_ring));
}

TEST_F(FullDiskTest, ARecordingMakesRoomWhileItGrows) {
  const fs::path old = leave("", 28, 100'000);
  auto ring = open();
  ASSERT_TRUE(ring) << ring.error().message;
  EXPECT_TRUE(fs::exists(old));
  other_bytes = 860'000;
  EXPECT_TRUE(ring->step(kNow_ns + kSecond_ns));
  EXPECT_FALSE(fs::exists(old));
  EXPECT_TRUE(fs::exists(ring->file()));
  other_bytes = 990'000;
  EXPECT_FALSE(ring->step(kNow_ns + 2 * kSecond_ns)) << "it ends before the disk is full";
  EXPECT_TRUE(fs::exists(ring->file()));
}

TEST_F(FullDiskTest, ADiskThatIsSmallerThanAFileIsUsedInTurn) {
  const fs::path kept = leave("kept", 1, 100'000);
  auto ring = open();
  ASSERT_TRUE(ring) << ring.error().message;
  const fs::path first = ring->file();
  const Status driven = drive(*ring, 150);  // 3 MB in 15 s of the 60 s that a file may have
  ASSERT_TRUE(driven) << driven.error().message;
  EXPECT_GT(ring->bytes_written(), 3'000'000U);
  EXPECT_FALSE(fs::exists(first));
  EXPECT_GE(files_in_ring(), 3U);
  EXPECT_TRUE(fs::exists(kept)) << "the black box of an earlier drive";
}

TEST_F(FullDiskTest, ADiskThatDoesNotTellItsSizeDoesNotEndAFile) {
  tells_size = false;
  auto ring = open();
  ASSERT_TRUE(ring) << ring.error().message;
  ASSERT_TRUE(drive(*ring, 50));
  EXPECT_EQ(files_in_ring(), 1U);
}

TEST_F(FullDiskTest, TheFilesOfEachRunAreNumberedFromOneAlsoIfItsTimeIsTaken) {
  ASSERT_TRUE(open()->finish());
  fs::rename(leave("kept", 28, 10), config_.directory / "kept/bevloc-20400301T000001Z-0001.mcap");
  config_.file_length = std::chrono::seconds(1);
  auto ring = open();
  ASSERT_TRUE(ring) << ring.error().message;
  EXPECT_EQ(ring->file().filename(), "bevloc-20400301T000002Z-0001.mcap");
  ASSERT_TRUE(ring->step(kNow_ns + kSecond_ns));
  EXPECT_EQ(ring->file().filename(), "bevloc-20400301T000002Z-0002.mcap");
}

TEST_F(FullDiskTest, CountsBytesOnceIfTheNextFileCannotBegin) {
  auto ring = open();
  ASSERT_TRUE(ring) << ring.error().message;
  other_bytes = 990'000;
  EXPECT_FALSE(ring->step(kNow_ns + 61 * kSecond_ns));
  EXPECT_EQ(ring->bytes_written(), fs::file_size(ring->file()));
}

TEST_F(FullDiskTest, KeepsTheBlackBoxAlsoIfItsFolderWasDeleted) {
  auto ring = open();
  ASSERT_TRUE(ring) << ring.error().message;
  fs::remove_all(config_.directory / "kept");
  const auto kept = ring->keep(kNow_ns + kSecond_ns);
  ASSERT_TRUE(kept) << kept.error().message;
  EXPECT_TRUE(fs::equivalent(*kept, ring->file()));
}

TEST_F(FullDiskTest, SaysThatTheBlackBoxIsNotKeptIfTheFileWasDeleted) {
  auto ring = open();
  ASSERT_TRUE(ring) << ring.error().message;
  fs::remove(ring->file());
  const auto kept = ring->keep(kNow_ns + kSecond_ns);
  ASSERT_FALSE(kept);
  EXPECT_NE(kept.error().message.find("cannot keep this file"), std::string::npos);
}

}  // namespace
}  // namespace bevloc::firmware
