// What a recording says about what it lacks, and about a file that does not belong to it.
#include <gmock/gmock.h>

#include "tests/evaluation/recording/hand_made_recording.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

bevloc::recording::Counters counters(uint64_t images, uint64_t events) {
  bevloc::recording::Counters message;
  message.set_images_not_recorded(images);
  message.set_events_not_recorded(events);
  return message;
}

TEST(RecordingGaps, NameTheImagesAndEventsThatWereNotRecorded) {
  const test::TemporaryFolder folder;
  test::HandMadeRecording made(folder / "bevloc-0001.mcap");
  made.add_pose(0.0, 0.0);
  made.add(firmware::kCountersTopic, counters(1, 0), 0.1);
  made.add(firmware::kCountersTopic, counters(12, 34), 0.2);
  EXPECT_THAT(
      made.open().gaps(),
      testing::ElementsAre(testing::EndsWith(
          "bevloc-0001.mcap: 12 images and 34 events were not recorded; the replay differs")));
}

TEST(RecordingGaps, AWholeRecordingHasNone) {
  const test::TemporaryFolder folder;
  test::HandMadeRecording made(folder / "bevloc-0001.mcap");
  made.add_pose(0.0, 0.0);
  made.add(firmware::kCountersTopic, counters(0, 0), 0.1);
  EXPECT_THAT(made.open().gaps(), testing::IsEmpty());
}

/// If the clock begins anew with each start, the names of several runs are mixed.
TEST(RecordingOfTwoRuns, NamesTheFilesOfTheFirstOne) {
  const test::TemporaryFolder folder;
  std::vector<std::filesystem::path> files;
  for (const auto& [name, offset] :
       {std::pair("bevloc-12-0001.mcap", "12"), std::pair("bevloc-13-0001.mcap", "13"),
        std::pair("bevloc-72-0002.mcap", "12")}) {
    test::HandMadeRecording made(folder / name, {{std::string(firmware::kClockOffsetKey), offset}});
    files.push_back(made.finish());
  }
  const auto mixed = Recording::open(files);
  ASSERT_FALSE(mixed);
  EXPECT_EQ(mixed.error().message,
            fmt::format("{1}: found a file of another run than {0}, wanted files of one run, such "
                        "as {0} {2}",
                        files[0].string(), files[1].string(), files[2].string()));
  EXPECT_TRUE(Recording::open({files[0], files[2]}));
}

}  // namespace
}  // namespace bevloc::evaluation
