#include "evaluation/map_turns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/campaign/integrity_command.h"
#include "evaluation/campaign/tune_matches_command.h"
#include "tests/evaluation/refusal.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;

TEST(MapTurns, EverySecondDriveHasAMapInTurn) {
  const std::vector<std::string> maps{"a", "b"};
  std::vector<std::string> given;
  for (int drive = 0; drive < 6; ++drive) given.push_back(map_of_drive(maps, drive));
  EXPECT_EQ(given, (std::vector<std::string>{"", "a", "", "b", "", "a"}));
  EXPECT_EQ(map_of_drive({}, 1), "");
}

TEST(MapTurns, AMapThatNoDriveUsesIsRefused) {
  EXPECT_TRUE(check_map_turns({}, "--drives", 1));
  EXPECT_TRUE(check_map_turns({"a"}, "--drives", 2));
  EXPECT_FALSE(check_map_turns({"a"}, "--drives", 1));
  EXPECT_EQ(check_map_turns({"a", "b"}, "--drives", 3).error().message,
            "--map: found 2 of them with --drives 3, wanted --drives 4 or more, because only every "
            "second drive goes through a map");
}

TEST(MapTurns, CommandsRefuseAMapThatNoDriveUses) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(test::refusal_of<IntegrityCommand>({"integrity", "--map", "a.osm"}),
              HasSubstr("--map: found 1 of them with --drives 1"));
  EXPECT_THAT(test::refusal_of<TuneMatchesCommand>(
                  {"matches", "--drives", "1", "--map", "a.osm", "--csv", folder / "matches.csv"}),
              HasSubstr("--map: found 1 of them with --drives 1"));
}

TEST(MapTurns, CommandsRefuseAMapThatCannotBeReadBeforeTheFirstDrive) {
  // Without a configuration there is no drive.
  const test::TemporaryFolder folder;
  EXPECT_THAT(test::refusal_of<IntegrityCommand>({"integrity", "--drives", "2", "--map",
                                                  "/no/such.osm", "--config", "/no/such.yaml"}),
              HasSubstr("/no/such.osm"));
  EXPECT_THAT(test::refusal_of<TuneMatchesCommand>({"matches", "--drives", "2", "--map",
                                                    "/no/such.osm", "--config", "/no/such.yaml",
                                                    "--csv", folder / "matches.csv"}),
              HasSubstr("/no/such.osm"));
}

}  // namespace
}  // namespace bevloc::evaluation
