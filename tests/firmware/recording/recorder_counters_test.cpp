// What the recorder counts: what is on the disk, and what is missing and why.
#include <csignal>
#include <vector>

#include <gmock/gmock.h>
#include <sys/resource.h>

#include "firmware/status/snapshot.h"
#include "tests/firmware/log_capture.h"
#include "tests/firmware/recording/recorder_fixture.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::Not;

/// No file of this process can become longer, until it is destroyed.
class FullDisk {
 public:
  FullDisk() {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{1, before_.rlim_max};
    std::signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, SIG_DFL);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

class RecorderCountersTest : public test::RecorderFixture {};

/// A JPEG is at most 65500 pixels wide.
TEST_F(RecorderCountersTest, AnImageThatCannotBeEncodedIsLeftOut) {
  config_.images = RecordedImages::kJpeg;
  pool_ = drivers::FramePool::create(2, 70'000, 2);
  const LogCapture log;
  const auto recorder = open();
  recorder->expect_images(0, 70'000, 2);
  recorder->note_image(frame(1, Time{}), Time{});
  recorder->note_solution(report(HealthState::kTracking, Time{}));
  recorder->finish(Time{});
  EXPECT_EQ(recorder->totals().images_dropped, 1U);
  EXPECT_EQ(recorder->counters().images, 0U);
  EXPECT_EQ(recorder->counters().events, 1U);
  EXPECT_FALSE(recorder->counters().failed);
  EXPECT_THAT(log.text(), HasSubstr("an image of camera front_left is left out"));
  EXPECT_THAT(log.text(), Not(HasSubstr("too slow")));
}

TEST_F(RecorderCountersTest, AnImageThatIsTooLargeIsNamedAsSuch) {
  pool_ = drivers::FramePool::create(2, 16, 9);
  const LogCapture log;
  const auto recorder = open();
  for (int i = 0; i < 2; ++i) {
    const Time now{std::chrono::seconds(i)};
    recorder->note_image(frame(1, now), now);
    recorder->write_queued(now);
  }
  recorder->finish(Time{std::chrono::seconds(2)});
  EXPECT_EQ(recorder->totals().images_dropped, 2U);
  EXPECT_THAT(log.text(), HasSubstr("1 images are left out because they are larger"));
  EXPECT_THAT(log.text(), Not(HasSubstr("2 images are left out"))) << "logged once";
  EXPECT_THAT(log.text(), Not(HasSubstr("too slow")));
}

TEST_F(RecorderCountersTest, ImagesThatFindNoMemoryAreDroppedAndCounted) {
  const auto recorder = open();
  for (uint64_t i = 0; i < 20; ++i) recorder->note_image(frame(i, Time{}), Time{});
  EXPECT_GT(recorder->counters().images_dropped, 0U);
  const LogCapture log;
  recorder->finish(Time{std::chrono::seconds(1)});
  EXPECT_EQ(recorder->counters().images + recorder->counters().images_dropped, 20U);
  EXPECT_THAT(log.text(), HasSubstr("because encoder or disk is too slow"));
}

TEST_F(RecorderCountersTest, EventsBeyondTheQueueAreDroppedAndCounted) {
  const auto recorder = open();
  for (int i = 0; i < 10'000; ++i) recorder->note_truth({Time{}, {}});
  EXPECT_EQ(recorder->events_dropped(), 10'000U - 8192U);
  recorder->finish(Time{std::chrono::seconds(1)});
  EXPECT_EQ(recorder->counters().events, 8192U);
}

TEST_F(RecorderCountersTest, WhatIsNotOnTheDiskAfterAFailureCountsAsDropped) {
  const LogCapture log;
  const auto recorder = open();
  auto full = std::make_unique<FullDisk>();
  for (int i = 0; i < 3; ++i) {
    const Time now{std::chrono::seconds(i)};
    recorder->note_image(frame(7, now), now);
    recorder->note_truth({now, {}});
    recorder->write_queued(now);
  }
  recorder->finish(Time{std::chrono::seconds(3)});
  full.reset();
  EXPECT_TRUE(recorder->counters().failed);
  EXPECT_EQ(recorder->counters().images, 0U);
  EXPECT_EQ(recorder->images_dropped(), 3U);
  EXPECT_TRUE(recorder->totals().failed);
  EXPECT_EQ(recorder->totals().images_dropped, 3U);
  EXPECT_EQ(recorder->counters().events, 0U);
  EXPECT_EQ(recorder->events_dropped(), 3U);
  EXPECT_THAT(log.text(), HasSubstr("3 images and 3 events dropped"));
  EXPECT_THAT(log.text(), Not(HasSubstr("too slow")));
}

TEST_F(RecorderCountersTest, NoTotalGoesDownWhenTheDiskFails) {
  const auto recorder = open();
  const auto record = [&](milliseconds time) {
    const Time now{time};
    recorder->note_image(frame(7, now), now);
    recorder->note_truth({now, {}});
    recorder->write_queued(now);
    return recorder->totals();
  };
  const RecordingSnapshot on_disk = record(milliseconds(0));
  EXPECT_EQ(on_disk.images, 1U);
  EXPECT_EQ(on_disk.events, 1U);
  const RecordingSnapshot in_memory = record(milliseconds(100));
  const auto full = std::make_unique<FullDisk>();
  const RecordingSnapshot failed = record(milliseconds(600));
  EXPECT_TRUE(failed.failed);
  EXPECT_GE(failed.images, in_memory.images);
  EXPECT_GE(failed.events, in_memory.events);
  EXPECT_GE(failed.bytes, in_memory.bytes);
  EXPECT_EQ(failed.images + failed.images_dropped, 3U);
  EXPECT_EQ(failed.events + failed.events_dropped, 3U);
}

TEST(ImageMemoryTest, LargeImagesTakeNotMoreMemoryThanTheUnitAllows) {
  EXPECT_EQ(ImageMemory::images_for(1, 1), ImageMemory::kMostImages);
  EXPECT_EQ(ImageMemory::images_for(1280, 720), ImageMemory::kMostImages);
  EXPECT_EQ(ImageMemory::images_for(7680, 4320), ImageMemory::kLeastImages);
  for (const int width_px : {640, 1280, 1600, 1920, 2048}) {
    const int height_px = width_px * 9 / 16;
    const int images = ImageMemory::images_for(width_px, height_px);
    const auto one_bytes = 3 * static_cast<size_t>(width_px) * static_cast<size_t>(height_px);
    EXPECT_LE(images * kCameraCount * one_bytes, ImageMemory::kMost_bytes) << width_px;
    EXPECT_GE(images, ImageMemory::kLeastImages) << width_px;
  }
}

TEST_F(RecorderCountersTest, ALargeCameraHasMemoryForFewImages) {
  constexpr int kWidth_px = 2048;
  constexpr int kHeight_px = 1536;
  pool_ = drivers::FramePool::create(3, kWidth_px, kHeight_px);
  ImageMemory memory(kWidth_px, kHeight_px);
  std::vector<RecordedImage> copies;
  for (uint64_t i = 0; i < 3; ++i) {
    if (auto copy = memory.copy(frame(i, Time{}), Time{})) copies.push_back(std::move(*copy));
  }
  EXPECT_EQ(copies.size(), 2U);
}

}  // namespace
}  // namespace bevloc::firmware
