#include "firmware/stages/capture_stage.h"

#include <gtest/gtest.h>

#include "tests/firmware/log_capture.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;

/// A camera whose failures the test sets.
class BrokenCamera final : public drivers::Camera {
 public:
  Status start() override {
    ++starts;
    if (clock != nullptr) clock->advance(start_duration);
    if (!start_error.empty()) return fail("{}", start_error);
    return {};
  }
  void stop() override {}
  Result<drivers::FrameEvent> next_frame(Duration, drivers::Frame& frame) override {
    if (is_unplugged) return fail("camera front: c1: is unplugged");
    frame.sequence = sequence++;
    frame.time = Time(milliseconds(100 * sequence)) + stamp_error;
    return is_silent ? drivers::FrameEvent::kTimeout : drivers::FrameEvent::kFrame;
  }
  drivers::CameraDescription description() const override { return {.camera = 1}; }
  drivers::CameraCounters counters() const override { return {}; }

  std::string start_error;
  bool is_unplugged = false;
  bool is_silent = false;
  drivers::VirtualClock* clock = nullptr;  ///< on which a start takes `start_duration`
  Duration start_duration{0};
  int starts = 0;
  uint64_t sequence = 10;
  Duration stamp_error{0};
};

class CaptureStageTest : public testing::Test {
 protected:
  /// Runs the stage every 100 ms.
  void run(Duration duration) {
    for (const Time end = clock_.now() + duration; clock_.now() < end;
         clock_.advance(milliseconds(100))) {
      EXPECT_TRUE(stage_.step(Duration::zero()));
    }
  }

  LogCapture log_;
  BrokenCamera camera_;
  drivers::VirtualClock clock_{Time(milliseconds(1000))};
  FrameQueue frames_{4};
  CaptureStage stage_{camera_, clock_, frames_};
};

TEST_F(CaptureStageTest, LogsAFailedStartOnceAndTriesAgain) {
  camera_.start_error = "camera front: c1: offers 1280x720 NV12; wanted nv12 640x360";
  run(milliseconds(3000));
  EXPECT_EQ(camera_.starts, 6);
  EXPECT_EQ(stage_.failures(), 6U);
  EXPECT_EQ(log_.text(),
            "warning: camera front: cannot start: c1: offers 1280x720 NV12; wanted nv12 640x360; "
            "trying again until it works\n");
}

TEST_F(CaptureStageTest, LogsAFailedStartAgainWhenTheReasonChanges) {
  camera_.start_error = "no such device";
  run(milliseconds(1000));
  camera_.start_error = "camera front: c1: another program uses it";
  run(milliseconds(1000));
  EXPECT_EQ(log_.text(),
            "warning: camera front: cannot start: no such device; trying again until it works\n"
            "warning: camera front: cannot start: c1: another program uses it; trying again until "
            "it works\n");
}

TEST_F(CaptureStageTest, LogsTheSameReasonAgainAfterAMinuteWithoutIt) {
  camera_.start_error = "no such device";
  run(milliseconds(1000));
  const std::string once = log_.text();
  camera_.start_error.clear();
  run(std::chrono::seconds(61));
  EXPECT_GT(stage_.captured(), 0U);
  EXPECT_EQ(log_.text(), once + "info: camera front: delivers frames again\n");
}

TEST_F(CaptureStageTest, LogsACameraThatStartsButFailsOnce) {
  camera_.is_unplugged = true;
  run(milliseconds(10'000));
  EXPECT_GT(camera_.starts, 10);
  EXPECT_EQ(log_.text(),
            "warning: camera front: fails: c1: is unplugged; trying again until it works\n");
}

TEST_F(CaptureStageTest, AFlappingCameraIsLoggedOnce) {
  for (int k = 0; k < 20; ++k) {
    camera_.is_unplugged = k % 2 == 0;
    run(milliseconds(1000));
  }
  const std::string text = log_.text();
  EXPECT_EQ(text.find("fails"), text.rfind("fails")) << text;
}

TEST_F(CaptureStageTest, LogsASilentCameraOnce) {
  camera_.is_silent = true;
  run(milliseconds(10'000));
  EXPECT_EQ(log_.text(),
            "warning: camera front: is silent: no frame for 2 s; check cable, power and trigger; "
            "trying again until it works\n");
  EXPECT_EQ(stage_.failures(), 0U);
}

TEST_F(CaptureStageTest, StartsASilentCameraAgainLessAndLessOften) {
  camera_.is_silent = true;
  run(std::chrono::seconds(15));
  EXPECT_EQ(camera_.starts, 2);
  run(std::chrono::seconds(30));
  EXPECT_EQ(camera_.starts, 3);
  run(std::chrono::seconds(3600));
  EXPECT_GT(camera_.starts, 20);
  EXPECT_LT(camera_.starts, 30);
  camera_.is_silent = false;
  run(milliseconds(3000));
  EXPECT_GT(stage_.captured(), 0U);
  camera_.is_silent = true;
  const int starts = camera_.starts;
  run(std::chrono::seconds(15));
  EXPECT_EQ(camera_.starts, starts + 1);
}

TEST_F(CaptureStageTest, MarksFramesWhoseStampsHaveJumped) {
  run(milliseconds(1000));
  while (const auto frame = frames_.pop(Duration::zero())) {
    EXPECT_FALSE(frame->stamp_jumped);
    EXPECT_EQ(frame->stamp_jumps, 0U);
  }
  camera_.stamp_error = milliseconds(-100);
  run(milliseconds(1000));
  while (const auto frame = frames_.pop(Duration::zero())) {
    EXPECT_TRUE(frame->stamp_jumped);
    EXPECT_EQ(frame->stamp_jumps, 1U);
  }
  EXPECT_EQ(log_.text(),
            "warning: camera front: its time stamps jumped, but its frames arrive as before; check "
            "its clock and its driver, then restart bevlocd\n");
}

TEST_F(CaptureStageTest, LogsNothingWhileTheCameraWorks) {
  run(milliseconds(1000));
  EXPECT_EQ(stage_.captured(), 10U);
  EXPECT_EQ(stage_.failures(), 0U);
  EXPECT_EQ(log_.text(), "");
}

TEST_F(CaptureStageTest, ACameraIsNotSilentWhileItStarts) {
  camera_.clock = &clock_;
  camera_.start_duration = std::chrono::seconds(12);
  camera_.is_silent = true;
  EXPECT_TRUE(stage_.step(Duration::zero()));
  EXPECT_EQ(stage_.failures(), 0U);
  EXPECT_EQ(log_.text(), "");
}

}  // namespace
}  // namespace bevloc::firmware
