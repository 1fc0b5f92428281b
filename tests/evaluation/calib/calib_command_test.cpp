// The command line of `bevloc calib`.
#include "evaluation/calib/calib_command.h"

#include <algorithm>

#include <gmock/gmock.h>

#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;

/// The message with which the command fails.
std::string error_of(std::vector<std::string> arguments) {
  CLI::App app;
  CalibCommand command;
  command.declare(app);
  arguments.insert(arguments.begin(), "calib");
  std::ranges::reverse(arguments);  // as CLI11 expects
  app.parse(arguments);
  const auto verdict = command.run();
  return verdict ? "no error" : verdict.error().message;
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

}  // namespace
}  // namespace bevloc::evaluation
