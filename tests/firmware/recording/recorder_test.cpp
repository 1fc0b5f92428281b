// The recorder: files and their order, the black box, and its messages.
#include "firmware/recording/recorder.h"

#include <cmath>
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

TEST_F(RecorderTest, APositionOfGpsdIsReadAsItWas) {
  RecordedFix fix;
  fix.time = Time{std::chrono::milliseconds(700)};
  fix.fix = {.latitude_deg = 49.01123456789,
             .longitude_deg = -8.40443210987,
             .sigma_north_m = 0.7,
             .sigma_east_m = 1.3,
             .speed_mps = 12.3,
             .course_deg = 271.25,
             .sigma_course_deg = 2.5,
             .utc = std::chrono::nanoseconds(1'795'000'000'125'000'000)};
  fix.held = {drivers::FixVerdict::kUsable, Time{std::chrono::milliseconds(610)},
              std::chrono::milliseconds(50)};
  const auto recorder = open();
  recorder->note_fix(fix);
  recorder->finish(Time{std::chrono::seconds(1)});
  const auto reader = mcap::Reader::open(first_in(config_.directory));
  ASSERT_TRUE(reader) << reader.error().message;
  const auto chunk = reader->read_chunk(0);
  ASSERT_TRUE(chunk && chunk->messages.size() == 1);
  const mcap::Message& message = chunk->messages[0];
  EXPECT_EQ(reader->channels().at(message.channel_id).topic, kGnssTopic);
  EXPECT_EQ(message.log_time_ns,
            static_cast<uint64_t>((test::kRecorderOffset + fix.time.time_since_epoch()).count()));
  foxglove::LocationFix recorded;
  ASSERT_TRUE(recorded.ParseFromArray(message.data.data(), static_cast<int>(message.data.size())));
  const auto read = fix_of(recorded, fix.time);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->time, fix.time);
  EXPECT_EQ(read->held.time, fix.held.time);
  EXPECT_EQ(read->held.sigma, fix.held.sigma);
  EXPECT_EQ(read->fix.latitude_deg, fix.fix.latitude_deg);
  EXPECT_EQ(read->fix.longitude_deg, fix.fix.longitude_deg);
  EXPECT_EQ(read->fix.sigma_north_m, fix.fix.sigma_north_m);
  EXPECT_EQ(read->fix.sigma_east_m, fix.fix.sigma_east_m);
  EXPECT_EQ(read->fix.speed_mps, fix.fix.speed_mps);
  EXPECT_EQ(read->fix.course_deg, fix.fix.course_deg);
  EXPECT_EQ(read->fix.sigma_course_deg, fix.fix.sigma_course_deg);
  EXPECT_EQ(read->fix.utc, fix.fix.utc);
}

TEST(FixMessage, ValuesThatNoReceiverReportsAreRefused) {
  RecordedFix good;
  good.fix.sigma_east_m = good.fix.sigma_north_m = 1.0;
  const foxglove::LocationFix message = fix_message(good, 0);
  ASSERT_TRUE(fix_of(message, Time{}));
  const auto refused = [&message](auto change) {
    foxglove::LocationFix changed = message;
    change(changed);
    return !fix_of(changed, Time{});
  };
  EXPECT_TRUE(refused([](auto& fix) { fix.set_latitude(91.0); }));
  EXPECT_TRUE(refused([](auto& fix) { fix.set_longitude(std::nan("")); }));
  EXPECT_TRUE(refused([](auto& fix) { fix.set_position_covariance(0, -1.0); }));
  EXPECT_TRUE(refused([](auto& fix) { fix.mutable_position_covariance()->Clear(); }));
  EXPECT_TRUE(refused([](auto& fix) { fix.set_speed_mps(-1.0); }));
  EXPECT_TRUE(refused([](auto& fix) { fix.set_course_deg(std::nan("")); }));
  EXPECT_TRUE(refused([](auto& fix) { fix.set_clock_sigma_ns(-1); }));
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
