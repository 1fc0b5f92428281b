// The command line of `bevloc calib`.
#include "evaluation/calib/calib_command.h"

#include <gmock/gmock.h>

#include "pipeline/calibration/rig_yaml.h"
#include "sim/sim_rig.h"
#include "tests/evaluation/calib/picture_folder.h"
#include "tests/evaluation/refusal.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/text.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;

/// The message with which the command fails.
std::string error_of(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "calib");
  return test::refusal_of<CalibCommand>(arguments);
}

TEST(CalibCommand, AFileMayFollowAnOptionWithAList) {
  const test::TemporaryFolder folder;
  const std::string out = (folder / "rig.yaml").string();
  const std::string gone = (folder / "gone.yaml").string();
  EXPECT_THAT(
      error_of({"import", "--out", out, "--map-camera", "a=front", "--map-camera", "b=back", gone}),
      HasSubstr("gone.yaml"));
  EXPECT_THAT(error_of({"import", "--out", out, "--token", "abc", gone}), HasSubstr("gone.yaml"));
  EXPECT_THAT(error_of({"refine", "--rig", gone, "--map", gone, "--keep", "focal", "--keep", "time",
                        "pictures"}),
              HasSubstr("gone.yaml"));
}

TEST(CalibCommand, AnImportWritesOverNoFileThatItReads) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "chain.yaml", "cam0: {}\n"));
  ASSERT_TRUE(write_file(folder / "extrinsics.yaml", "front: {}\n"));
  for (const char* input : {"chain.yaml", "extrinsics.yaml"}) {
    EXPECT_THAT(error_of({"import", folder / "chain.yaml", "--extrinsics",
                          folder / "extrinsics.yaml", "--out", folder / input}),
                HasSubstr(std::string(input) + ": found a file to write that is also read"));
  }
  EXPECT_EQ(test::read_text(folder / "chain.yaml"), "cam0: {}\n");
}

TEST(CalibCommand, ARefinedRigReplacesOnlyARig) {
  const test::TemporaryFolder folder;
  test::write_picture_folder(folder.path(), 10);
  ASSERT_TRUE(write_file(folder / "rig.yaml", format_rig(sim::nominal_rig())));
  ASSERT_TRUE(
      write_file(folder / "town.osm",
                 test::read_text(BEVLOC_SOURCE_DIR "/tests/pipeline/map/fixtures/street.osm")));
  const auto error_with = [&](const std::string& out, const std::string& json) {
    return error_of({"refine", folder.path(), "--rig", folder / "rig.yaml", "--map",
                     folder / "town.osm", "--out", folder / out, "--json", folder / json});
  };
  for (const std::string input : {"town.osm", "front/frames.txt"}) {
    EXPECT_THAT(error_with(input, "new.json"),
                HasSubstr(input + ": found a file to write that is also read"));
  }
  EXPECT_THAT(error_with("new", "new"), HasSubstr("new: found one name for two files to write"));
}

TEST(CalibCommand, WritesOverNoFileThatItReads) {
  const test::TemporaryFolder folder;
  test::write_picture_folder(folder.path(), 10);
  ASSERT_TRUE(write_file(folder / "rig.yaml", format_rig(sim::nominal_rig())));
  ASSERT_TRUE(
      write_file(folder / "town.osm",
                 test::read_text(BEVLOC_SOURCE_DIR "/tests/pipeline/map/fixtures/street.osm")));
  for (const char* command : {"check", "refine"}) {
    for (const char* input :
         {"rig.yaml", "town.osm", "reference.csv", "front/frames.txt", "back/picture.png"}) {
      for (const char* option : {"--json", "--picture"}) {
        const std::string before = test::read_text(folder / input);
        EXPECT_THAT(error_of({command, folder.path(), "--rig", folder / "rig.yaml", "--map",
                              folder / "town.osm", option, folder / input}),
                    HasSubstr(std::string(input) + ": found a file to write that is also read"));
        EXPECT_EQ(test::read_text(folder / input), before);
      }
    }
  }
}

}  // namespace
}  // namespace bevloc::evaluation
