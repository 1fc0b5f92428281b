#include "evaluation/bench/stages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/bench/allocation_count.h"
#include "evaluation/bench/whole_frame.h"

namespace bevloc::bench {
namespace {

using testing::ElementsAreArray;

class StagesTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    config_ = new evaluation::DriveConfig(
        evaluation::load_drive_config(BEVLOC_SOURCE_DIR "/config/demo.yaml").value());
    scene_ = new Scene(make_scene(*config_, 2, 2).value());
    index_ = new MapIndex(scene_->map);
  }
  static void TearDownTestSuite() {
    delete index_;
    delete scene_;
    delete config_;
  }

  static evaluation::DriveConfig* config_;
  static Scene* scene_;
  static MapIndex* index_;
};
evaluation::DriveConfig* StagesTest::config_ = nullptr;
Scene* StagesTest::scene_ = nullptr;
MapIndex* StagesTest::index_ = nullptr;

TEST_F(StagesTest, HasEveryStageInOrderWithItsWork) {
  const auto stages = Stages::create(*config_, *scene_, *index_, 1);
  ASSERT_TRUE(stages) << stages.error().message;
  std::vector<std::string> names;
  (*stages)->go_to(scene_->places[0]);
  (*stages)->begin_frame(scene_->places[0].framesets[0]);
  for (const Stage& stage : (*stages)->all()) {
    names.push_back(stage.name);
    EXPECT_EQ(stage.work.macs > 0.0, stage.name.starts_with("network")) << stage.name;
    stage.run();
  }
  EXPECT_THAT(names, ElementsAreArray(kStageNames));
}

TEST_F(StagesTest, WholeFrameIsTrackedAndSendsCanFramesAtEachPlace) {
  auto whole = WholeFrame::create(*config_, scene_->rig, scene_->map, *index_, 1);
  ASSERT_TRUE(whole) << whole.error().message;
  for (const Place& place : scene_->places) {
    EXPECT_TRUE((*whole)->settle(place));
    const FrameRun run = (*whole)->run(place.framesets[1]);
    EXPECT_TRUE(run.tracked);
    EXPECT_GT(run.can_frames, 3);
    EXPECT_GT(run.time.count(), 0);
  }
}

TEST_F(StagesTest, StagesOutsideTheNetworkDoNotAllocate) {
  if (!malloc_is_counted()) GTEST_SKIP() << "a sanitizer replaces malloc";
  const auto stages = Stages::create(*config_, *scene_, *index_, 1);
  ASSERT_TRUE(stages) << stages.error().message;
  (*stages)->go_to(scene_->places[0]);
  for (int frame = 0; frame < 3; ++frame) {
    (*stages)->begin_frame(scene_->places[0].framesets[0]);
    for (const Stage& stage : (*stages)->all()) {
      const uint64_t before = allocation_count();
      stage.run();
      if (frame < 2 || !stage.in_frame || stage.name.starts_with("network")) continue;
      EXPECT_EQ(allocation_count(), before) << stage.name;
    }
  }
}

}  // namespace
}  // namespace bevloc::bench
