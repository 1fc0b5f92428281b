#include "drivers/camera/replay/replay_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/drivers/recording.h"

namespace bevloc::drivers {
namespace {

using std::chrono::milliseconds;
using testing::EndsWith;
using testing::HasSubstr;

ReplayCameraConfig config_for(const Recording& recording) {
  ReplayCameraConfig config;
  config.camera = 3;
  config.directory = recording.directory();
  config.width_px = 4;
  config.height_px = 2;
  config.readout = milliseconds(20);
  return config;
}

TEST(LoadRecording, ReadsTheIndex) {
  const Recording recording;
  recording.add_image("a.png", 4, 2, {1, 2, 3});
  recording.add_image("b.png", 4, 2, {1, 2, 3});
  recording.write("frames.txt", "# sequence time_ns file\n\n7 1000 a.png\n9 2000 b.png # a gap\n");
  const auto frames = load_recording(recording.directory());
  ASSERT_TRUE(frames) << frames.error().message;
  ASSERT_EQ(frames->size(), 2U);
  EXPECT_EQ((*frames)[1].sequence, 9U);
  EXPECT_EQ((*frames)[1].time, Time(Duration(2000)));
  EXPECT_EQ((*frames)[1].file, recording.directory() / "b.png");
}

TEST(LoadRecording, NamesTheBadLineOfTheIndex) {
  struct Case {
    std::string index;
    std::string wanted;
  };
  const std::vector<Case> cases = {
      {"", "frames.txt: found no images"},
      {"0 1000 a.png\n1 soon a.png\n", "frames.txt:2: found \"1 soon a.png\""},
      {"0 1000\n", "frames.txt:1: found \"0 1000\""},
      {"-1 1000 a.png\n", "frames.txt:1: found"},
      {"0 1000 a.png b.png\n", "frames.txt:1: found"},
      {"# comment\n0 1000 gone.png\n", "frames.txt:2: found no file"},
      {"0 1000 a.png\n0 2000 a.png\n",
       "frames.txt:2: found sequence 0 and time 2000 after 0 and 1000, wanted"},
      {"0 1000 a.png\n1 1000 a.png\n",
       "frames.txt:2: found sequence 1 and time 1000 after 0 and 1000, wanted"},
  };
  for (const Case& wrong : cases) {
    const Recording recording;
    recording.add_image("a.png", 4, 2, {1, 2, 3});
    recording.write("frames.txt", wrong.index);
    const auto frames = load_recording(recording.directory());
    ASSERT_FALSE(frames) << wrong.index;
    EXPECT_THAT(frames.error().message, HasSubstr(wrong.wanted));
    EXPECT_THAT(frames.error().message, HasSubstr(recording.directory().string()));
  }
}

TEST(ReplayCamera, StartFailsWithoutARecording) {
  const Recording empty;
  VirtualClock clock;
  ReplayCamera camera(config_for(empty), clock);
  const Status started = camera.start();
  ASSERT_FALSE(started);
  EXPECT_THAT(
      started.error().message,
      HasSubstr("frames.txt: found no readable file, wanted the index of a picture folder"));
}

TEST(ReplayCamera, PlaysImagesAtTheirShiftedTimes) {
  const Recording recording;
  recording.add_image("a.png", 4, 2, {250, 10, 20});
  recording.add_image("b.png", 4, 2, {10, 20, 250});
  recording.write("frames.txt", "40 9000000000 a.png\n42 9100000000 b.png\n");
  VirtualClock clock;
  ReplayCameraConfig config = config_for(recording);
  config.shift = -milliseconds(8900);
  ReplayCamera camera(config, clock);
  ASSERT_TRUE(camera.start());
  Frame frame;
  ASSERT_EQ(camera.next_frame(milliseconds(500), frame), FrameEvent::kFrame);
  EXPECT_EQ(clock.now(), Time(milliseconds(120)));
  EXPECT_EQ(frame.time, Time(milliseconds(100)));
  EXPECT_EQ(frame.sequence, 0U);
  EXPECT_EQ(frame.camera, 3);
  const uint8_t* pixel = frame.pixels().row(1) + 9;
  EXPECT_EQ(pixel[0], 250);
  EXPECT_EQ(pixel[1], 10);
  EXPECT_EQ(pixel[2], 20);
  ASSERT_EQ(camera.next_frame(milliseconds(500), frame), FrameEvent::kFrame);
  EXPECT_EQ(frame.sequence, 2U);
  EXPECT_EQ(frame.pixels().row(0)[2], 250);
  EXPECT_EQ(camera.next_frame(milliseconds(500), frame), FrameEvent::kEnded);
}

TEST(ReplayCamera, NamesTheFileThatItCannotRead) {
  const Recording recording;
  recording.write("text.png", "not an image");
  recording.add_image("wide.png", 5, 2, {1, 2, 3});
  recording.add_image("good.png", 4, 2, {1, 2, 3});
  recording.write("frames.txt",
                  "0 100000000 text.png\n1 200000000 wide.png\n2 300000000 good.png\n");
  VirtualClock clock;
  ReplayCamera camera(config_for(recording), clock);
  ASSERT_TRUE(camera.start());
  Frame frame;
  const auto text = camera.next_frame(milliseconds(900), frame);
  ASSERT_FALSE(text);
  EXPECT_THAT(text.error().message,
              EndsWith("text.png: found a file that is neither PNG nor JPEG, wanted an image"));
  const auto wide = camera.next_frame(milliseconds(900), frame);
  ASSERT_FALSE(wide);
  EXPECT_THAT(wide.error().message, EndsWith("wide.png: found an image of 5x2 pixels, wanted 4x2"));
  ASSERT_EQ(camera.next_frame(milliseconds(900), frame), FrameEvent::kFrame);
  EXPECT_EQ(frame.sequence, 2U);
  EXPECT_EQ(camera.counters().damaged, 2U);
}

}  // namespace
}  // namespace bevloc::drivers
