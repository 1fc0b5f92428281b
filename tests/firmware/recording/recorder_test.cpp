// The recorder: files and their order, the black box, and its messages.
#include "firmware/recording/recorder.h"

#include <fstream>

#include <gtest/gtest.h>

#include "common/mcap/reader.h"
#include "firmware/recording/messages.h"
#include "firmware/recording/topics.h"
#include "tests/firmware/recording/recorder_fixture.h"

namespace bevloc::firmware {
namespace {

namespace fs = std::filesystem;

class RecorderTest : public test::RecorderFixture {};

TEST_F(RecorderTest, ImagesKeepTheirPixelsAndTimes) {
  const auto recorder = open();
  const Time exposed{std::chrono::milliseconds(70)};
  recorder->note_image(frame(42, exposed), exposed + std::chrono::milliseconds(28));
  recorder->finish(Time{std::chrono::milliseconds(100)});
  EXPECT_EQ(recorder->counters().images, 1U);
  const auto reader = mcap::Reader::open(first_in(config_.directory));
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_TRUE(reader->complete());
  const auto chunk = reader->read_chunk(0);
  ASSERT_TRUE(chunk);
  ASSERT_EQ(chunk->messages.size(), 1U);
  const mcap::Message& message = chunk->messages[0];
  EXPECT_EQ(reader->channels().at(message.channel_id).topic, "/camera/front_left");
  EXPECT_EQ(message.log_time_ns,
            static_cast<uint64_t>((test::kRecorderOffset + std::chrono::milliseconds(98)).count()));
  foxglove::RawImage image;
  ASSERT_TRUE(image.ParseFromArray(message.data.data(), static_cast<int>(message.data.size())));
  EXPECT_EQ(image.encoding(), "rgb8");
  EXPECT_EQ(image.sequence(), 42U);
  EXPECT_EQ(image.exposure_ns(), 8'000'000);
  EXPECT_EQ(image.data(), std::string(16 * 8 * 3, '\x2a'));
}

TEST_F(RecorderTest, NamesAFileByTheTimeInUtcAlsoAfter2038) {
  open()->finish(Time{});
  EXPECT_EQ(first_in(config_.directory).filename(), "bevloc-20400301T000000Z-0001.mcap");
}

TEST_F(RecorderTest, EventsDoNotWaitForManyImages) {
  const auto recorder = open();
  recorder->expect_images(1, 16, 8);
  for (uint64_t i = 0; i < 6; ++i) {
    recorder->note_image(frame(i, Time{}), Time{});
    auto other = frame(i, Time{});
    other.camera = 1;
    recorder->note_image(other, Time{});
  }
  for (int i = 0; i < 500; ++i) recorder->note_truth({Time{}, {}});
  recorder->write_queued(Time{});
  EXPECT_EQ(recorder->counters().events, 500U);
  EXPECT_EQ(recorder->counters().images, 6U);
  recorder->finish(Time{std::chrono::seconds(1)});
  EXPECT_EQ(recorder->counters().images, 12U);
}

TEST_F(RecorderTest, TheRingDeletesItsOldestFiles) {
  config_.file_length = std::chrono::seconds(1);
  config_.max_bytes = 200'000;
  const auto recorder = open();
  const fs::path first = first_in(config_.directory);
  uintmax_t most_bytes = 0;
  for (int second = 0; second < 60; ++second) {
    const Time now{std::chrono::seconds(second)};
    for (uint64_t i = 0; i < 6; ++i) {
      recorder->note_image(noisy_frame(i, now, second), now);
    }
    recorder->write_queued(now);
    most_bytes = std::max(most_bytes, bytes_in_ring());
  }
  recorder->finish(Time{std::chrono::seconds(60)});
  EXPECT_FALSE(fs::exists(first));
  EXPECT_LE(most_bytes, config_.max_bytes);
  EXPECT_GT(files_in(config_.directory), 5U);
}

TEST_F(RecorderTest, TheRingMakesRoomForAFileThatGrows) {
  const fs::path oldest = leave("bevloc-20400224T000000Z-0001.mcap", 65'000);
  const fs::path middle = leave("bevloc-20400225T000000Z-0001.mcap", 65'000);
  const fs::path latest = leave("bevloc-20400226T000000Z-0001.mcap", 65'000);
  config_.max_bytes = 200'000;
  const auto recorder = open();
  EXPECT_TRUE(fs::exists(oldest));
  for (int step = 0; step < 12; ++step) {
    const Time now{step * std::chrono::milliseconds(500)};
    for (uint64_t i = 0; i < 6; ++i) recorder->note_image(noisy_frame(i, now, step), now);
    recorder->write_queued(now);
    EXPECT_LE(bytes_in_ring(), config_.max_bytes) << step;
  }
  recorder->finish(Time{std::chrono::seconds(6)});
  EXPECT_GT(recorder->counters().bytes, 5'000U);
  EXPECT_FALSE(fs::exists(oldest));
  EXPECT_TRUE(fs::exists(middle));
  EXPECT_TRUE(fs::exists(latest));
}

TEST_F(RecorderTest, AFullRingDeletesFilesOfTheFutureFirst) {
  const fs::path before = leave("bevloc-20400224T000000Z-0001.mcap", 60'000);
  const fs::path future = leave("bevloc-20500101T000000Z-0001.mcap", 60'000);
  config_.max_bytes = 100'000;
  open()->finish(Time{});
  EXPECT_TRUE(fs::exists(before));
  EXPECT_FALSE(fs::exists(future));
}

TEST_F(RecorderTest, AFileThatSomebodyRenamedIsNotDeleted) {
  const fs::path renamed = leave("bevloc-accident.mcap", 60'000);
  const fs::path copied = leave("bevloc-20400224T000000Z-0001-copy.mcap", 60'000);
  const fs::path own = leave("bevloc-20400224T000000Z-0001.mcap", 60'000);
  config_.max_bytes = 100'000;
  open()->finish(Time{});
  EXPECT_TRUE(fs::exists(renamed));
  EXPECT_TRUE(fs::exists(copied));
  config_.max_bytes = 50'000;
  open()->finish(Time{});
  EXPECT_FALSE(fs::exists(own));
}

TEST_F(RecorderTest, LostKeepsWhatAShortRingStillHas) {
  config_.file_length = std::chrono::seconds(1);
  const auto recorder = open();
  for (int second = 0; second < 10; ++second) {
    const Time now{std::chrono::seconds(second)};
    recorder->note_solution(report(HealthState::kTracking, now));
    recorder->write_queued(now);
  }
  ASSERT_TRUE(fs::remove(first_in(config_.directory))) << "as a full ring does";
  const Time lost{std::chrono::seconds(10)};
  recorder->note_solution(report(HealthState::kLost, lost));
  recorder->write_queued(lost);
  EXPECT_EQ(recorder->counters().black_boxes, 1U);
  EXPECT_EQ(files_in(config_.directory / "kept"), 9U) << "ten files, of which the first is gone";
}

TEST_F(RecorderTest, LostKeepsTheLastMinuteAlsoInManyFiles) {
  config_.file_length = std::chrono::seconds(1);
  config_.black_box_files = 2;
  const fs::path of_earlier_run = leave("kept/bevloc-20400224T000000Z-0001.mcap", 10);
  const fs::path of_the_future = leave("kept/bevloc-20500101T000000Z-0001.mcap", 10);
  const auto recorder = open();
  for (int second = 0; second < 10; ++second) {
    const Time now{std::chrono::seconds(second)};
    recorder->note_solution(report(HealthState::kTracking, now));
    recorder->write_queued(now);
  }
  const Time lost{std::chrono::seconds(10)};
  recorder->note_solution(report(HealthState::kLost, lost));
  recorder->write_queued(lost);
  EXPECT_EQ(files_in(config_.directory / "kept"), 10U);
  EXPECT_FALSE(fs::exists(of_earlier_run));
  EXPECT_FALSE(fs::exists(of_the_future));
}

TEST_F(RecorderTest, LostKeepsTheLastMinute) {
  config_.file_length = std::chrono::seconds(30);
  const auto recorder = open();
  const auto drive = [&](int from_s, int to_s, HealthState state) {
    for (int second = from_s; second < to_s; ++second) {
      const Time now{std::chrono::seconds(second)};
      recorder->note_solution(report(state, now));
      recorder->write_queued(now);
    }
  };
  drive(0, 200, HealthState::kTracking);
  EXPECT_EQ(files_in(config_.directory / "kept"), 0U);
  drive(200, 210, HealthState::kLost);
  // 60 s before second 200: the files from second 120, 150 and 180 on.
  EXPECT_EQ(files_in(config_.directory / "kept"), 3U);
  EXPECT_EQ(recorder->counters().black_boxes, 1U);
  recorder->finish(Time{std::chrono::seconds(210)});
  const auto kept = mcap::Reader::open(first_in(config_.directory / "kept"));
  ASSERT_TRUE(kept);
  EXPECT_TRUE(kept->complete());
}

TEST_F(RecorderTest, AFullBlackBoxDeletesFilesOfTheFutureFirst) {
  config_.black_box_files = 2;
  for (const char* date : {"20500101", "20500102"}) {
    leave("kept/bevloc-" + std::string(date) + "T000000Z-0001.mcap", 10);
  }
  const auto recorder = open();
  for (const auto state : {HealthState::kTracking, HealthState::kLost}) {
    recorder->note_solution(report(state, Time{}));
    recorder->write_queued(Time{});
  }
  EXPECT_TRUE(fs::exists(config_.directory / "kept/bevloc-20400301T000000Z-0001.mcap"));
  EXPECT_EQ(files_in(config_.directory / "kept"), 2U);
}

TEST_F(RecorderTest, AFolderThatCannotBeMadeIsRefused) {
  config_.directory = "/proc/no/such";
  const auto recorder = Recorder::open(config_, {}, test::kRecorderOffset, Time{});
  ASSERT_FALSE(recorder);
  EXPECT_NE(recorder.error().message.find("/proc/no/such"), std::string::npos);
}

TEST_F(RecorderTest, AFolderIsCheckedWithoutMakingIt) {
  EXPECT_TRUE(check_folder(folder_ / "new/folder"));
  EXPECT_FALSE(fs::exists(folder_ / "new"));
  std::ofstream(folder_ / "file") << "x";
  for (const char* place : {"file", "file/below"}) {
    const Status checked = check_folder(folder_ / place);
    ASSERT_FALSE(checked) << place;
    EXPECT_NE(checked.error().message.find("(Not a directory)"), std::string::npos)
        << checked.error().message;
  }
}

TEST(RecordedMessagesTest, AMapSurvivesWithoutLoss) {
  HdMap map;
  map.name = "street";
  map.origin = {49.0123456789, 8.4};
  map.elements.push_back(
      {ElementClass::kRoadBoundary, Appearance::kKerb, {{0.1, -1e-9}, {1.0 / 3.0, 5.0}}});
  const auto read = map_of(map_message(map));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->origin.latitude_deg, map.origin.latitude_deg);
  ASSERT_EQ(read->elements.size(), 1U);
  EXPECT_EQ(read->elements[0].points, map.elements[0].points);
  EXPECT_EQ(read->elements[0].appearance, Appearance::kKerb);
}

TEST(RecordedMessagesTest, ALargeMapIsLeftOut) {
  HdMap map;
  map.elements.resize(1);
  map.elements[0].points.resize(kMostMapPoints + 1);
  EXPECT_FALSE(map_of(map_message(map)));
}

TEST(RecordedMessagesTest, BusFramesAreCheckedWhenTheyAreRead) {
  RecordedBusFrame frame;
  frame.frame.id = 0x321;
  frame.frame.length = 2;
  frame.frame.data[1] = 7;
  recording::CanFrame message = bus_message(frame);
  ASSERT_TRUE(bus_frame_of(message));
  EXPECT_EQ(bus_frame_of(message)->frame, frame.frame);
  message.set_id(0x800);
  EXPECT_FALSE(bus_frame_of(message));
  message.set_id(1);
  message.set_data(std::string(65, 'x'));
  EXPECT_FALSE(bus_frame_of(message));
}

TEST(RecordedMessagesTest, APoseSurvives) {
  const Se2 pose{1.5, -2.5, 3.0};
  const Se2 read = pose_of(pose_message(pose, 1));
  EXPECT_DOUBLE_EQ(read.x_m, pose.x_m);
  EXPECT_DOUBLE_EQ(read.y_m, pose.y_m);
  EXPECT_NEAR(read.yaw_rad, pose.yaw_rad, 1e-12);
}

}  // namespace
}  // namespace bevloc::firmware
