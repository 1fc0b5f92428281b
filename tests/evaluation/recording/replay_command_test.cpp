// What a replay refuses to write, and what it says about a recording that it cannot repeat exactly.
#include "evaluation/recording/replay_command.h"

#include <gmock/gmock.h>

#include "common/files.h"
#include "common/version.h"
#include "evaluation/recording/replay_inputs.h"
#include "tests/evaluation/recording/hand_made_recording.h"
#include "tests/evaluation/recording/replay_config.h"
#include "tests/evaluation/refusal.h"
#include "tests/firmware/log_capture.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// What the replay says when it is to write over this file, which must keep its content.
void expect_kept(const std::filesystem::path& file, const std::vector<std::string>& words) {
  const std::string bytes = read_file(file).value();
  EXPECT_THAT(test::refusal_of<ReplayCommand>(words),
              StartsWith(file.string() + ": found a file to write that is also read"));
  EXPECT_EQ(read_file(file).value(), bytes);
}

TEST(ReplayCommand, NeverWritesOverTheRecording) {
  const test::TemporaryFolder folder;
  const std::string out = folder / "out";
  test::HandMadeRecording made(folder / "bevloc-0001.mcap");
  made.add_pose(0.0, 0.0);
  const std::string recording = made.finish();
  expect_kept(recording, {"replay", recording, "--json", recording, "--out", out});
}

TEST(ReplayCommand, NeverWritesOverTheLogOrTheConfiguration) {
  const test::TemporaryFolder folder;
  for (const char* name : {"can.log", "config.yaml"}) {
    ASSERT_TRUE(write_file(folder / name, "(1.000000) can0 7F0#00\n"));
  }
  const std::vector<std::string> words{
      "replay",      "--from-candump", folder / "can.log",     "--images",
      folder.path(), "--config",       folder / "config.yaml", "--out"};
  const auto with = [&words](std::initializer_list<std::string> more) {
    std::vector<std::string> all = words;
    all.insert(all.end(), more);
    return all;
  };
  expect_kept(folder / "can.log", with({folder.path()}));
  expect_kept(folder / "config.yaml", with({folder / "out", "--json", folder / "config.yaml"}));
}

TEST(ReplaySetup, WarnsOfARecordingOfAnotherVersion) {
  const test::TemporaryFolder folder;
  ReplayOverrides overrides;
  overrides.config = folder / "config.yaml";
  ASSERT_TRUE(write_file(overrides.config, test::replay_config_text()));
  const auto said_about = [&](const std::string& recorded) {
    test::HandMadeRecording made(folder / "bevloc-0001.mcap", {{"version", recorded}});
    made.add_pose(0.0, 0.0);
    auto recording = made.open();
    const ScratchFolder scratch = ScratchFolder::create().value();
    const firmware::LogCapture log;
    const auto setup = setup_of(recording, overrides, scratch);
    EXPECT_TRUE(setup) << setup.error().message;
    std::filesystem::remove(folder / "bevloc-0001.mcap");
    return log.text();
  };
  EXPECT_THAT(said_about("0.0.1-other"), HasSubstr("found a recording of bevloc 0.0.1-other"));
  EXPECT_THAT(said_about(std::string(version())), Not(HasSubstr("found a recording of bevloc")));
}

TEST(ReplaySetup, NeedsThePositionsOfGpsdThatTheConfigurationTakes) {
  const test::TemporaryFolder folder;
  ReplayOverrides overrides;
  overrides.config = folder / "config.yaml";
  const std::string gnss = "gnss: {driver: gpsd, antenna_m: [0, 0], latency_ms: 90}\n";
  ASSERT_TRUE(write_file(overrides.config, test::replay_config_text() + gnss));
  const auto open_with_fixes = [&folder](int count) {
    const std::string name = fmt::format("{}-0001.mcap", count);
    test::HandMadeRecording made(folder / name);
    made.add_pose(0.0, 0.0);
    firmware::RecordedFix fix;
    fix.fix.sigma_east_m = fix.fix.sigma_north_m = 1.0;
    for (int i = 0; i < count; ++i) {
      made.add(firmware::kGnssTopic, firmware::fix_message(fix, 0), 0.1 * i);
    }
    return made.open();
  };
  const ScratchFolder scratch = ScratchFolder::create().value();
  Recording without = open_with_fixes(0);
  const auto refused = setup_of(without, overrides, scratch);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("found no positions of gpsd"));
  Recording with = open_with_fixes(3);
  const auto setup = setup_of(with, overrides, scratch);
  ASSERT_TRUE(setup) << setup.error().message;
  const auto inputs = inputs_of(with, setup->rig);
  ASSERT_TRUE(inputs) << inputs.error().message;
  ASSERT_EQ(inputs->fixes.size(), 3U);
  EXPECT_EQ(inputs->fixes[2].time - inputs->fixes[0].time, std::chrono::milliseconds(200));
}

TEST(BusText, SaysThatADriveInRealTimeCannotBeEqual) {
  const BusComparison different{10, 12, 3, "recorded A, replayed B"};
  const std::string text = bus_text(different, true);
  EXPECT_THAT(text, HasSubstr("the first 3 are equal"));
  EXPECT_THAT(text, HasSubstr("recorded A, replayed B"));
  EXPECT_THAT(text, HasSubstr("real time"));
  EXPECT_THAT(bus_text(different, false), Not(HasSubstr("real time")));
  const BusComparison equal{10, 10, 10, std::nullopt};
  EXPECT_EQ(bus_text(equal, true),
            "bus       10 frames, equal to the recorded ones byte for byte\n");
}

}  // namespace
}  // namespace bevloc::evaluation
