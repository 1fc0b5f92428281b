// `bevloc tune matches`: what it drives through, and what its pictures show.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/campaign/campaign.h"
#include "evaluation/campaign/match_recorder.h"
#include "evaluation/campaign/tune_matches_command.h"
#include "pipeline/calibration/rig_yaml.h"
#include "tests/evaluation/own_config.h"
#include "tests/evaluation/refusal.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;

/// What the command says of one short drive with a configuration that has these keys.
std::string refusal_of_drive(const test::OwnKeys& keys) {
  const test::TemporaryFolder folder;
  return test::refusal_of<TuneMatchesCommand>(
      {"matches", "--config", test::write_own_config(folder.path(), keys), "--drives", "1",
       "--duration", "1", "--csv", folder / "matches.csv"});
}

TEST(TuneMatchesTest, DrivesThroughTheMapOfItsConfiguration) {
  EXPECT_THAT(refusal_of_drive({.map = "file: /no/such.osm", .calibration = "", .simulation = ""}),
              HasSubstr("/no/such.osm"));
}

TEST(TuneMatchesTest, RefusesFaultsOfItsConfiguration) {
  EXPECT_THAT(refusal_of_drive({.map = "procedural_seed: 7",
                                .calibration = "",
                                .simulation = "  faults: [{kind: gnss_outage}]\n"}),
              HasSubstr("found simulation.faults, wanted none, because matches are measured"));
}

TEST(TuneMatchesTest, AMapIsThatOfOneDrive) {
  const test::TemporaryFolder folder;
  const auto config = load_faultless_config(test::write_own_config(folder.path()), "");
  ASSERT_TRUE(config) << config.error().message;
  const DriveConfig on_map = config_of_drive(*config, 2001, "a.osm");
  EXPECT_EQ(on_map.map_file, "a.osm");
  EXPECT_EQ(on_map.simulation->town_seed, std::nullopt);
  const DriveConfig in_town = config_of_drive(*config, 2002, "");
  EXPECT_EQ(in_town.map_file, "");
  EXPECT_EQ(in_town.simulation->town_seed, 2002U);
}

/// The matches of one frameset, in a town with this street.
Result<std::vector<MeasuredPlace>> matches_in(const StreetConfig& street) {
  const test::TemporaryFolder folder;
  const auto config = load_faultless_config(test::write_own_config(folder.path()), "");
  if (!config) return tl::unexpected(config.error());
  const auto rig = read_rig(config->rig_file);
  if (!rig) return tl::unexpected(rig.error());
  DriveConfig driven = config_of_drive(*config, 2050, "");
  driven.simulation->duration_s = 0.1;
  driven.simulation->street = street;
  return record_matches(driven, *rig, 0, [](double) {});
}

TEST(TuneMatchesTest, ThePicturesShowTheStreetOfTheConfiguration) {
  const auto usual = matches_in({});
  ASSERT_TRUE(usual) << usual.error().message;
  ASSERT_EQ(usual->size(), 1U);
  StreetConfig other;
  other.looks = 1.5;
  const auto changed = matches_in(other);
  ASSERT_TRUE(changed) << changed.error().message;
  EXPECT_NE(to_csv({*usual}), to_csv({*changed}));
}

TEST(TuneMatchesTest, RefusesPhotographs) {
  StreetConfig street;
  street.photos = "/no/photos";
  const auto refused = matches_in(street);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("own.yaml: found simulation.street.photos"));
}

}  // namespace
}  // namespace bevloc::evaluation
