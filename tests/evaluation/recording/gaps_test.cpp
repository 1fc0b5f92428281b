// What a recording says about what it lacks.
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

}  // namespace
}  // namespace bevloc::evaluation
