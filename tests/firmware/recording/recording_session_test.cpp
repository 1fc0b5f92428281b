// Tests what a recording says about the files that the appliance uses.
#include "firmware/recording/recording_session.h"

#include <gtest/gtest.h>

#include "common/files.h"
#include "common/mcap/reader.h"
#include "firmware/recording/topics.h"
#include "pipeline/calibration/rig_yaml.h"
#include "tests/firmware/recording/recorder_fixture.h"

namespace bevloc::firmware {
namespace {

class RecordingSessionTest : public test::RecorderFixture {};

TEST_F(RecordingSessionTest, AttachesTheFilesAsTheyWereRead) {
  Config config;
  config.record = config_;
  config.file = folder_ / "bevlocd.yaml";
  config.rig_file = folder_ / "rig.yaml";
  config.can.dbc_file = folder_ / "vehicle.dbc";
  config.can.vehicle.emplace();
  config.learned_calibration_file = folder_ / "learned.yaml";
  for (const auto& file : {config.file, config.rig_file, config.can.dbc_file}) {
    ASSERT_TRUE(write_file(file, "old"));
    config.kept_files.keep(file);
    ASSERT_TRUE(write_file(file, "new"));
  }
  ASSERT_TRUE(write_file(config.learned_calibration_file, "of the drive before"));
  const Rig rig = read_rig(BEVLOC_SOURCE_DIR "/config/rig_demo.yaml").value();
  const auto recorder = open_recorder(config, rig, {}, false, Time{});
  ASSERT_TRUE(recorder) << recorder.error().message;
  (*recorder)->finish(Time{});

  const auto reader = mcap::Reader::open(first_in(config_.directory));
  ASSERT_TRUE(reader) << reader.error().message;
  for (const std::string_view name : {kConfigAttachment, kRigAttachment, kDbcAttachment}) {
    const mcap::Attachment* attached = reader->attachment(name);
    ASSERT_NE(attached, nullptr) << name;
    EXPECT_EQ(attached->data, "old") << name;
  }
  const mcap::Attachment* learned = reader->attachment(kLearnedAttachment);
  ASSERT_NE(learned, nullptr);
  EXPECT_EQ(learned->data, "of the drive before");
}

}  // namespace
}  // namespace bevloc::firmware
