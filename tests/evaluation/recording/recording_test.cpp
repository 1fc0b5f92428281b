// A simulated drive is recorded and replayed: the replay sends the same frames, byte for byte. A
// report is made of it. One drive serves all tests.
#include "evaluation/recording/recording.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "common/files.h"
#include "evaluation/drive/simulated_run.h"
#include "evaluation/recording/replay_inputs.h"
#include "evaluation/recording/replay_setup.h"
#include "evaluation/recording/track.h"
#include "evaluation/report/report_page.h"
#include "firmware/recording/recording_file.h"
#include "firmware/recording/topics.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/map/map_checksum.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> recordings_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".mcap") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

/// A drive of four seconds in lockstep with raw images, in files of two seconds.
class RecordedDriveTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    auto config = load_drive_config(std::string(BEVLOC_SOURCE_DIR) + "/config/demo.yaml");
    ASSERT_TRUE(config) << config.error().message;
    config->simulation->seed = 2018;
    config->simulation->town_seed = 2018;
    config->simulation->duration_s = 4.0;
    config->record.emplace();
    config->record->directory = *folder_ / "recording";
    config->record->images = firmware::RecordedImages::kRaw;
    config->record->file_length = std::chrono::seconds(2);
    const auto rig = read_rig(config->rig_file);
    ASSERT_TRUE(rig) << rig.error().message;
    SimulatedRunOptions options;
    options.fast = true;
    options.show_progress = false;
    options.out = folder_->path();
    const auto report = run_simulation(*config, *rig, options,
                                       [](const firmware::ApplianceView&) { return false; });
    ASSERT_TRUE(report) << report.error().message;
    captured_ = report->frames.captured;
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  void SetUp() override {
    files_ = recordings_in(*folder_ / "recording");
    ASSERT_GE(files_.size(), 2U);
    auto recording = Recording::open(files_);
    ASSERT_TRUE(recording) << recording.error().message;
    recording_ = std::make_unique<Recording>(std::move(*recording));
  }

  static test::TemporaryFolder* folder_;
  static uint64_t captured_;
  std::vector<fs::path> files_;
  std::unique_ptr<Recording> recording_;
};

test::TemporaryFolder* RecordedDriveTest::folder_ = nullptr;
uint64_t RecordedDriveTest::captured_ = 0;

TEST_F(RecordedDriveTest, TheReplaySendsTheSameFramesByteForByte) {
  const ScratchFolder scratch = ScratchFolder::create().value();
  const auto setup = setup_of(*recording_, {}, scratch);
  ASSERT_TRUE(setup) << setup.error().message;
  const auto inputs = inputs_of(*recording_, setup->rig);
  ASSERT_TRUE(inputs) << inputs.error().message;
  const auto outcome = replay(*setup, *inputs, *folder_ / "replayed.log");
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_GT(outcome->framesets, 30U);

  const auto recorded = played_frames(*recording_, firmware::kBusOutTopic);
  ASSERT_TRUE(recorded);
  const BusComparison bus = compare_bus(*recorded, outcome->sent);
  EXPECT_FALSE(bus.different) << *bus.different;
  EXPECT_EQ(bus.recorded, bus.replayed);
  EXPECT_GT(bus.equal, 2000U);

  // The judge's log of the live drive ends before the sign-off.
  const std::string live = read_file(*folder_ / "can.log").value();
  const std::string replayed = read_file(*folder_ / "replayed.log").value();
  ASSERT_GT(live.size(), 100'000U);
  EXPECT_TRUE(replayed.starts_with(live));
}

/// The positions that a receiver on the rear axle gives along this track, ten in a second. Each one
/// arrives 80 ms after its moment.
std::vector<firmware::RecordedFix> fixes_along(const Track& track, const GeoOrigin& origin) {
  constexpr Duration kAge = std::chrono::milliseconds(80);
  can::GeoReference geo({origin.latitude_deg, origin.longitude_deg});
  std::vector<firmware::RecordedFix> fixes;
  for (Time time = track.front().time; time < track.back().time;
       time += std::chrono::milliseconds(100)) {
    const auto pose = pose_at(track, time);
    if (!pose) continue;
    const can::GeodeticPose geodetic = geo.geodetic_from_map(*pose);
    firmware::RecordedFix& fix = fixes.emplace_back();
    fix.time = time + kAge;
    fix.fix = {.latitude_deg = geodetic.position.latitude_deg,
               .longitude_deg = geodetic.position.longitude_deg,
               .sigma_north_m = 1.0,
               .sigma_east_m = 1.0,
               .speed_mps = 8.0,
               .course_deg = geodetic.heading_deg};
    fix.held = {drivers::FixVerdict::kUsable, time, std::chrono::milliseconds(10)};
  }
  return fixes;
}

TEST_F(RecordedDriveTest, PositionsOfGpsdLeadToThePose) {
  const ScratchFolder scratch = ScratchFolder::create().value();
  auto setup = setup_of(*recording_, {}, scratch);
  ASSERT_TRUE(setup) << setup.error().message;
  auto inputs = inputs_of(*recording_, setup->rig);
  const auto truth = read_track(*recording_, firmware::kTruthTopic);
  ASSERT_TRUE(inputs && truth);
  setup->config.gnss.emplace();
  const auto last_pose = [&] {
    const auto outcome = replay(*setup, *inputs, *folder_ / "gpsd.log");
    return outcome ? outcome->poses.back() : ReplayedPose{};
  };
  EXPECT_FALSE(last_pose().map_from_vehicle) << "the positions of the bus do not count";
  inputs->fixes = fixes_along(*truth, setup->map.origin);
  const ReplayedPose pose = last_pose();
  const auto expected = pose_at(*truth, pose.time);
  ASSERT_TRUE(pose.map_from_vehicle && expected);
  EXPECT_EQ(pose.state, HealthState::kTracking);
  EXPECT_LT(std::hypot(pose.map_from_vehicle->x_m - expected->x_m,
                       pose.map_from_vehicle->y_m - expected->y_m),
            0.5);
}

TEST_F(RecordedDriveTest, EveryFrameIsThereAndTheMapIsTheSame) {
  size_t images = 0;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    images += recording_->messages(firmware::image_topic(camera)).size();
  }
  EXPECT_EQ(images, captured_);
  const auto map = recording_->map();
  ASSERT_TRUE(map && *map);
  EXPECT_EQ(fmt::format("{:08x}", map_checksum(**map)),
            recording_->value(firmware::kMapChecksumKey));
  EXPECT_TRUE(recording_->cut_files().empty());
  EXPECT_EQ(recording_->value(firmware::kLockstepKey), "yes");
}

TEST_F(RecordedDriveTest, ATimeThatIsNotRecordedIsNamedAndNotCounted) {
  ASSERT_GE(files_.size(), 3U);
  EXPECT_TRUE(recording_->pauses().empty());
  auto recording = Recording::open({files_[0], files_[2]});
  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->pauses().size(), 1U);
  EXPECT_NE(recording->gaps().front().find("nothing is recorded from"), std::string::npos);
  const auto data = read_report_data(*recording);
  ASSERT_TRUE(data) << data.error().message;
  double recorded_s = 0.0;
  for (const StatePeriod& period : data->periods) recorded_s += period.end_s - period.begin_s;
  EXPECT_LT(recorded_s, data->length_s - 1.5);
  const double missing_s =
      1e-9 * static_cast<double>(recording->pauses()[0].begin_ns - recording->begin_ns()) + 1.0;
  const auto sentences = explain(*data, missing_s);
  ASSERT_EQ(sentences.size(), 1U);
  EXPECT_TRUE(sentences[0].starts_with("Nothing is recorded from ")) << sentences[0];
}

TEST_F(RecordedDriveTest, EachLatencyOfALaterFileIsThatOfItsOwnFramesets) {
  auto recording = Recording::open({files_[1]});
  ASSERT_TRUE(recording) << recording.error().message;
  const auto data = read_report_data(*recording);
  ASSERT_TRUE(data) << data.error().message;
  EXPECT_GT(data->latency_ms.size(), 5U);
  for (const TimedValue& latency : data->latency_ms) EXPECT_LT(latency.value, 40.0);
}

TEST_F(RecordedDriveTest, ADamagedRigIsNotReplacedByAnother) {
  std::string bytes = read_file(files_[0]).value();
  const size_t translation = bytes.find("translation_m: [");
  ASSERT_NE(translation, std::string::npos);
  bytes[translation + 18] = static_cast<char>(bytes[translation + 18] ^ 1);
  const fs::path damaged = *folder_ / "damaged.mcap";
  ASSERT_TRUE(write_file(damaged, bytes));
  auto recording = Recording::open({damaged});
  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_FALSE(recording->gaps().empty());
  EXPECT_NE(recording->gaps().front().find("found a damaged attachment rig"), std::string::npos);
  const auto setup = setup_of(*recording, {}, ScratchFolder::create().value());
  ASSERT_FALSE(setup);
  EXPECT_NE(setup.error().message.find("found a damaged attachment rig"), std::string::npos);
}

TEST_F(RecordedDriveTest, ACutFileReplaysUpToItsCut) {
  const std::string whole = read_file(files_[0]).value();
  const fs::path cut = *folder_ / "cut.mcap";
  ASSERT_TRUE(write_file(cut, std::string_view(whole).substr(0, whole.size() * 2 / 3)));
  auto recording = Recording::open({cut});
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->cut_files().size(), 1U);
  const ScratchFolder scratch = ScratchFolder::create().value();
  const auto setup = setup_of(*recording, {}, scratch);
  ASSERT_TRUE(setup) << setup.error().message;
  const auto inputs = inputs_of(*recording, setup->rig);
  ASSERT_TRUE(inputs);
  const auto outcome = replay(*setup, *inputs, *folder_ / "cut.log");
  ASSERT_TRUE(outcome) << outcome.error().message;
  const auto recorded = played_frames(*recording, firmware::kBusOutTopic);
  ASSERT_TRUE(recorded);
  const BusComparison bus = compare_bus(*recorded, outcome->sent);
  EXPECT_GT(bus.recorded, 300U);
  // The cut may lie between the bus frames of a cycle and its images. A cycle has at most 20
  // frames.
  EXPECT_LE(bus.recorded - bus.equal, 20U) << bus.different.value_or("");
}

TEST_F(RecordedDriveTest, ABeginningWithoutAHeadIsNamedAsSuch) {
  const std::string whole = read_file(files_[0]).value();
  const fs::path cut = *folder_ / "head.mcap";
  for (const size_t bytes : {0, 5, 100}) {
    ASSERT_TRUE(write_file(cut, std::string_view(whole).substr(0, bytes)));
    const auto recording = Recording::open({cut});
    ASSERT_FALSE(recording) << bytes;
    EXPECT_NE(recording.error().message.find(fmt::format("found {} bytes without", bytes)),
              std::string::npos)
        << recording.error().message;
  }
}

TEST_F(RecordedDriveTest, OfADamagedFileTheBeginningIsRead) {
  std::string bytes = read_file(files_[0]).value();
  const auto reader = mcap::Reader::parse(bytes, "whole");
  ASSERT_TRUE(reader && reader->chunks().size() >= 3);
  const mcap::ChunkPlace bad = reader->chunks()[2];
  bytes[bad.offset + 200] = static_cast<char>(bytes[bad.offset + 200] ^ 1);
  const fs::path damaged = *folder_ / "damaged.mcap";
  ASSERT_TRUE(write_file(damaged, bytes));
  auto recording = Recording::open({damaged});
  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->gaps().size(), 1U);
  EXPECT_NE(recording->gaps()[0].find(fmt::format("offset {}: found", bad.offset)),
            std::string::npos)
      << recording->gaps()[0];
  EXPECT_FALSE(recording->messages(firmware::kSolutionTopic).empty());
  EXPECT_LE(recording->end_ns(), bad.last_ns);
  EXPECT_TRUE(read_report_data(*recording));
}

TEST_F(RecordedDriveTest, AnotherModelIsUsedWhenItIsNamed) {
  const ScratchFolder scratch = ScratchFolder::create().value();
  const fs::path model = std::string(BEVLOC_SOURCE_DIR) + "/models/nano_float.onnx";
  const auto setup = setup_of(*recording_, {{}, model, {}}, scratch);
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->config.model_file, model);
  EXPECT_FALSE(setup->config.record);
}

TEST_F(RecordedDriveTest, ARigWithImagesOfAnotherSizeIsRefused) {
  Rig rig = setup_of(*recording_, {}, ScratchFolder::create().value()).value().rig;
  rig.cameras[1].intrinsics.width_px /= 2;
  const auto inputs = inputs_of(*recording_, rig);
  ASSERT_FALSE(inputs);
  EXPECT_NE(inputs.error().message.find(": found images of "), std::string::npos);
}

TEST_F(RecordedDriveTest, TheReportTellsErrorsStatesAndReasons) {
  const auto data = read_report_data(*recording_);
  ASSERT_TRUE(data) << data.error().message;
  EXPECT_GT(data->truth.size(), 30U);
  ASSERT_GE(data->periods.size(), 2U);
  EXPECT_EQ(data->periods.front().state, HealthState::kInit);
  EXPECT_GT(data->matches.size(), 20U);
  const auto sentences = explain(*data, data->length_s - 0.1);
  ASSERT_GE(sentences.size(), 4U);
  EXPECT_NE(sentences[0].find(to_string(data->periods.back().state)), std::string::npos)
      << sentences[0];
  const std::string page =
      report_page(*data, {"a & b"}, {}, choose_frames(*data), {{"Why?", sentences}});
  EXPECT_NE(page.find("a &amp; b"), std::string::npos);
  EXPECT_NE(page.find("Errors against the truth"), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos) << "an outside address";
  EXPECT_EQ(page.find("nan"), std::string::npos);
}

TEST_F(RecordedDriveTest, AMomentIsReadAsTimeOfDayOrSeconds) {
  const auto data = read_report_data(*recording_);
  ASSERT_TRUE(data);
  EXPECT_DOUBLE_EQ(parse_moment(*data, "1.5").value(), 1.5);
  const std::string time = time_of_day(*data, 2.0);
  EXPECT_NEAR(parse_moment(*data, time).value(), 2.0, 0.11);
  EXPECT_TRUE(parse_moment(*data, time.substr(0, 5)));
  for (const std::string& first : {std::string("0"), time_of_day(*data, 0.0).substr(0, 5)}) {
    const auto sentences = explain(*data, parse_moment(*data, first).value());
    EXPECT_NE(sentences[0].find("the state was"), std::string::npos) << sentences[0];
  }
  EXPECT_FALSE(parse_moment(*data, "noon"));
  EXPECT_FALSE(parse_moment(*data, time.substr(0, 5) + "pm"));
  EXPECT_FALSE(parse_moment(*data, time.substr(0, 5) + ":99"));
  for (const char* text : {"1e9", "nan", "-nan", "inf", "14:32:nan"}) {
    EXPECT_FALSE(parse_moment(*data, text)) << text;
  }
}

TEST_F(RecordedDriveTest, AFileCountsOnceByWhicheverName) {
  const fs::path kept = *folder_ / "kept.mcap";
  fs::create_hard_link(files_[0], kept);
  auto files = files_;
  files.insert(files.begin(), {kept, files_[1]});
  const auto recording = Recording::open(files);
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->messages(firmware::kBusInTopic).size(),
            recording_->messages(firmware::kBusInTopic).size());
}

TEST_F(RecordedDriveTest, ACopyOfAFileIsRefused) {
  const fs::path copy = *folder_ / "copy.mcap";
  fs::copy(files_[1], copy);
  const auto recording = Recording::open({files_[0], files_[1], copy});
  ASSERT_FALSE(recording);
  EXPECT_EQ(recording.error().message, copy.string() + ": found the same messages as in " +
                                           files_[1].string() +
                                           ", wanted each file of the run once");
}

TEST_F(RecordedDriveTest, FilesOfTwoRunsAreRefused) {
  auto head = firmware::RecordingHead{{{"log_time_minus_clock_ns", "5"}}, {}, {}};
  auto other = firmware::RecordingFile::create(*folder_ / "other.mcap", head, 1);
  ASSERT_TRUE(other);
  ASSERT_TRUE(other->finish());
  const auto both = Recording::open({files_[0], *folder_ / "other.mcap"});
  ASSERT_FALSE(both);
  EXPECT_NE(both.error().message.find("of another run"), std::string::npos);
}

/// A recording is replayed although the files that were used for it have changed or are gone.
TEST(MovedRecordingTest, HoldsTheDbcFileAndWhatItsConfigurationNames) {
  const fs::path own = fs::path(BEVLOC_SOURCE_DIR) / "config";
  const test::TemporaryFolder folder;
  fs::create_directory(folder / "config");
  fs::create_directory_symlink(own.parent_path() / "models", folder / "models");
  for (const char* name : {"demo_own_bus.yaml", "vehicle_demo.dbc", "rig_demo.yaml"}) {
    fs::copy(own / name, folder / "config" / name);
  }
  auto config = load_drive_config(folder / "config/demo_own_bus.yaml");
  ASSERT_TRUE(config) << config.error().message;
  config->simulation->duration_s = 0.5;
  config->record.emplace();
  config->record->directory = folder / "recording";
  SimulatedRunOptions options;
  options.fast = true;
  options.show_progress = false;
  options.out = folder.path();
  const auto report = run_simulation(*config, read_rig(config->rig_file).value(), options,
                                     [](const firmware::ApplianceView&) { return false; });
  ASSERT_TRUE(report) << report.error().message;

  fs::remove(folder / "config/vehicle_demo.dbc");
  fs::remove(folder / "config/rig_demo.yaml");
  std::ofstream(folder / "config/demo_own_bus.yaml", std::ios::app) << "manifest: none\n";
  auto recording = Recording::open(recordings_in(folder / "recording"));
  ASSERT_TRUE(recording) << recording.error().message;
  const auto setup = setup_of(*recording, {}, ScratchFolder::create().value());
  ASSERT_TRUE(setup) << setup.error().message;
  ASSERT_TRUE(setup->config.can.vehicle);
  EXPECT_EQ(setup->config.can.vehicle->signals.size(), config->can.vehicle->signals.size());
  EXPECT_EQ(setup->config.model_file, folder / "config/../models/nano.onnx");
}

}  // namespace
}  // namespace bevloc::evaluation
