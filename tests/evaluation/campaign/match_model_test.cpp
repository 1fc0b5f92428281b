#include "evaluation/campaign/match_model.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/files.h"
#include "tests/support/pose_matchers.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

const HypothesisGrid kTracking;
const HypothesisGrid kAcquiring{{4.0, 0.2}, {3.0, 0.2}, {radians(4.0), radians(0.2)}};

MeasuredMatch measured(SearchRange range, const Se2& truth, const Se2& found) {
  MeasuredMatch match;
  match.range = range;
  match.truth = truth;
  match.found = found;
  match.sigma = {0.1, 0.05, radians(0.1)};
  return match;
}

/// A drive of 200 m whose matches are 0.2 m too far to the left from 100 m on. Where the truth is
/// 1.5 m to the left of the prior, the solver found the border of its range.
MatchTable biased_table() {
  MatchTable table;
  for (int frame = 0; frame < 200; ++frame) {
    const double error_m = frame < 100 ? 0.0 : 0.2;
    MeasuredPlace place{.drive = 0, .frame = frame, .station_m = 1.0 * frame, .matches = {}};
    place.matches.push_back(measured(SearchRange::kTracking, {0.1, 0.0, 0.0}, {0.1, error_m, 0.0}));
    place.matches.push_back(measured(SearchRange::kTracking, {0.0, 1.5, 0.0}, {0.0, 1.0, 0.0}));
    place.matches.push_back(measured(SearchRange::kAcquiring, {1.0, 1.0, 0.0}, {1.0, 1.0, 0.0}));
    table.places.push_back(place);
  }
  return table;
}

TEST(MatchModelTest, KeepsMeasuredErrorsWhereverThePriorIs) {
  const MatchTable table = biased_table();
  MatchModel model(table, kTracking, kAcquiring, 1);
  const Se2 truth{-0.4, 0.3, radians(0.5)};
  for (int i = 0; i < 300; ++i) {
    const Se2 found = model.match({1.0 * i, 0.0}, SearchRange::kTracking, truth).correction;
    const double error_m = (truth.inverse() * found).y_m;
    EXPECT_TRUE(std::abs(error_m) < 1e-9 || std::abs(error_m - 0.2) < 1e-9) << error_m;
  }
}

TEST(MatchModelTest, KeepsErrorsCorrelatedOverDistance) {
  const MatchTable table = biased_table();
  MatchModel model(table, kTracking, kAcquiring, 1);
  int changes = 0;
  double before_m = -1.0;
  for (int i = 0; i < 3000; ++i) {
    const Se2 found = model.match({1.0 * i, 0.0}, SearchRange::kTracking, Se2()).correction;
    changes += std::abs(found.y_m - before_m) > 0.1 ? 1 : 0;
    before_m = found.y_m;
  }
  // Blocks have 30 to 90 m, so 3 km have about 50; errors that are drawn anew would change 1500
  // times.
  EXPECT_GT(changes, 5);
  EXPECT_LT(changes, 100);
}

TEST(MatchModelTest, IsConfidentlyWrongBeyondTheBorder) {
  const MatchTable table = biased_table();
  MatchModel model(table, kTracking, kAcquiring, 1);
  const MatchResult result = model.match({0.0, 0.0}, SearchRange::kTracking, {0.0, 1.7, 0.0});
  EXPECT_THAT(result.correction, test::PoseNear(Se2{0.0, 1.0, 0.0}, 1e-9, 1e-9));
  EXPECT_NEAR(std::sqrt(result.covariance(1, 1)), 0.05, 1e-9);
  const MatchResult wide = model.match({0.0, 0.0}, SearchRange::kAcquiring, {0.0, 1.7, 0.0});
  EXPECT_THAT(wide.correction, test::PoseNear(Se2{0.0, 1.7, 0.0}, 1e-9, 1e-9));
}

TEST(MatchModelTest, NeverAnswersOutsideTheRange) {
  const MatchTable table = biased_table();
  MatchModel model(table, kTracking, kAcquiring, 1);
  const MatchResult result = model.match({0.0, 0.0}, SearchRange::kTracking, {-30.0, 12.0, 1.0});
  EXPECT_LE(std::abs(result.correction.x_m), 2.0);
  EXPECT_LE(std::abs(result.correction.y_m), 1.0);
  EXPECT_LE(std::abs(result.correction.yaw_rad), radians(2.0));
}

TEST(MatchModelTest, APeakAtTheBorderHasItsMassThere) {
  MatchTable table;
  MeasuredPlace place{.drive = 0, .frame = 0, .station_m = 0.0, .matches = {}};
  place.matches.push_back(measured(SearchRange::kTracking, {}, {}));
  place.matches.push_back(measured(SearchRange::kAcquiring, {}, {}));
  table.places.push_back(place);
  MatchModel model(table, kTracking, kAcquiring, 1);
  const auto edge_mass = [&](const Se2& truth) {
    return model.match({0.0, 0.0}, SearchRange::kAcquiring, truth).edge_mass;
  };
  EXPECT_LT(edge_mass({0.0, 2.0, 0.0}).maxCoeff(), 1e-6);
  // This correction lies between the second and the third hypothesis from the border.
  EXPECT_NEAR(edge_mass({0.0, -2.7, 0.0}).y(), 0.5, 1e-6);
  EXPECT_GT(edge_mass({0.0, 2.95, 0.0}).y(), 0.99);
  EXPECT_GT(edge_mass({3.95, 0.0, 0.0}).x(), 0.99);
  EXPECT_GT(edge_mass({0.0, 0.0, radians(3.95)}).z(), 0.99);
}

TEST(MatchModelTest, ScattersWhileTheVehicleStands) {
  MatchTable table;
  for (int frame = 0; frame < 100; ++frame) {
    MeasuredPlace place{.drive = 0, .frame = frame, .station_m = 0.0, .matches = {}};
    const double noise_m = frame % 2 == 0 ? 0.03 : -0.03;
    place.matches.push_back(measured(SearchRange::kTracking, {}, {0.0, 0.1 + noise_m, 0.0}));
    place.matches.push_back(measured(SearchRange::kAcquiring, {}, {}));
    table.places.push_back(place);
  }
  MatchModel model(table, kTracking, kAcquiring, 1);
  double sum_m = 0.0;
  double squares_m2 = 0.0;
  constexpr int kRepetitions = 1000;
  for (int i = 0; i < kRepetitions; ++i) {
    const double y_m = model.match({5.0, 0.0}, SearchRange::kTracking, Se2()).correction.y_m;
    sum_m += y_m;
    squares_m2 += y_m * y_m;
  }
  const double mean_m = sum_m / kRepetitions;
  const double scatter_m = std::sqrt(squares_m2 / kRepetitions - mean_m * mean_m);
  EXPECT_NEAR(mean_m, 0.1, 0.04);  // the constant part does not average out
  EXPECT_NEAR(scatter_m, 0.042, 0.005);
}

TEST(MatchModelTest, RepeatsItselfWithTheSameSeed) {
  const MatchTable table = biased_table();
  MatchModel first(table, kTracking, kAcquiring, 7);
  MatchModel second(table, kTracking, kAcquiring, 7);
  for (int i = 0; i < 200; ++i) {
    const MatchedPlace place{0.7 * i, 0.0};
    const MatchResult a = first.match(place, SearchRange::kTracking, Se2());
    const MatchResult b = second.match(place, SearchRange::kTracking, Se2());
    EXPECT_EQ(a.correction.y_m, b.correction.y_m);
  }
}

TEST(MatchTableTest, SurvivesTheWayThroughAFile) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "matches.csv";
  MatchTable table = biased_table();
  table.places[3].curvature_radpm = -0.05;
  table.places[3].matches[0].correlation = {0.5, -0.25, 0.0};
  table.places[3].matches[0].rival_peak = {0.0, 0.75, 0.0};
  table.places[3].matches[0].score = 0.35;
  table.places[3].matches[0].axis_score = {0.1, 0.2, 0.3};
  ASSERT_TRUE(write_file(file, to_csv(table)));
  const auto read = read_match_table(file);
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->places.size(), table.places.size());
  const MeasuredPlace& place = read->places[3];
  EXPECT_NEAR(place.curvature_radpm, -0.05, 1e-5);
  ASSERT_EQ(place.matches.size(), 3);
  EXPECT_THAT(place.matches[1].found, test::PoseNear(Se2{0.0, 1.0, 0.0}, 1e-3, 1e-5));
  EXPECT_NEAR(place.matches[0].covariance()(0, 1), 0.5 * 0.1 * 0.05, 1e-6);
  EXPECT_NEAR(place.matches[0].rival_peak.y(), 0.75, 0.01);
  EXPECT_NEAR(place.matches[0].score, 0.35, 0.01);
  EXPECT_NEAR(place.matches[0].axis_score.z(), 0.3, 0.01);
}

TEST(MatchTableTest, SaysWhichLineIsBad) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "matches.csv";
  std::string text = to_csv(biased_table());
  text += "1,2,three\n";
  ASSERT_TRUE(write_file(file, text));
  const auto read = read_match_table(file);
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, testing::HasSubstr(":602: found '1,2,three'"));
}

TEST(MatchTableTest, RefusesAnUnknownRange) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "matches.csv";
  std::string text = to_csv(biased_table());
  text += "0,200,200000,0,2,0,0,0,0,0,0,100,50,100,0,0,0,0,0,0,0,0,0,0,0,0,0\n";
  ASSERT_TRUE(write_file(file, text));
  const auto read = read_match_table(file);
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, testing::HasSubstr(file + ":602: found the range 2"));
}

TEST(MatchTableTest, RefusesADriveWithoutMatchesOfBothRanges) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "matches.csv";
  MatchTable table = biased_table();
  for (MeasuredPlace& place : table.places) {
    if (place.frame < 100) continue;
    place.drive = 7;
    std::erase_if(place.matches, [](const MeasuredMatch& match) {
      return match.range == SearchRange::kAcquiring;
    });
  }
  ASSERT_TRUE(write_file(file, to_csv(table)));
  const auto read = read_match_table(file);
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message,
              testing::HasSubstr(file + ": found no match of range 1 (acquiring) in drive 7"));
}

TEST(MatchModelTest, APlaceBesideTheTrueOneHasTheScoreThatWasMeasuredThere) {
  MatchTable table = biased_table();
  for (MeasuredPlace& place : table.places) {
    place.matches[0].score = 0.35;
    MeasuredMatch beside = measured(SearchRange::kTracking, {0.0, -3.0, 0.0}, {0.0, 0.0, 0.0});
    beside.score = 0.1;
    place.matches.push_back(beside);
  }
  MatchModel model(table, kTracking, kAcquiring, 1);
  const Se2 truth{0.2, 0.1, 0.0};
  const MatchResult match =
      model.match_beside({10.0, 0.0}, SearchRange::kTracking, truth, {0.0, 3.0, 0.0});
  EXPECT_EQ(match.score, 0.1);
  EXPECT_NEAR(match.correction.y_m, 3.1, 0.25);
}

}  // namespace
}  // namespace bevloc::evaluation
