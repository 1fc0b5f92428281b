// What `bevloc localize` says about one match.
#include "evaluation/localize/localize_report.h"

#include <gmock/gmock.h>

#include "common/json_dump.h"
#include "pipeline/tracker/measurements.h"

namespace bevloc::evaluation {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

MatchResult clear_match() {
  MatchResult match;
  match.evidence = Evidence::kGood;
  match.correction = {0.4, -0.2, 0.01};
  match.covariance = Eigen::Vector3d(0.04, 0.01, 1e-5).asDiagonal();
  match.evidence_share = {0.9, 0.8, 0.7};
  match.score = 0.33;
  match.axis_score = {0.3, 0.4, 0.4};
  match.rival_peak = {0.1, 0.2, 0.3};
  return match;
}

Localization localization_of(MatchResult match) {
  Localization localization;
  localization.seen = judge_single(match);
  localization.match = match;
  localization.cameras.set();
  return localization;
}

TEST(LocalizeReport, AClearMatchIsTrusted) {
  const Localization localization = localization_of(clear_match());
  EXPECT_THAT(text_of(localization),
              AllOf(HasSubstr("trusted: yes"), Not(HasSubstr("border of the search"))));
  const nlohmann::json json = json_of(localization);
  EXPECT_EQ(json["trusted"], true);
  EXPECT_EQ(json["at_border"], nlohmann::json::array({false, false, false}));
  EXPECT_EQ(json["rival_peak"], nlohmann::json::array({0.1, 0.2, 0.3}));
  EXPECT_DOUBLE_EQ(json["sigma"][1], pose_sigma(clear_match()).y());
}

TEST(LocalizeReport, AnAnswerAtTheBorderHasNoSigma) {
  MatchResult match = clear_match();
  match.edge_mass.y() = 0.9;
  Localization localization = localization_of(match);
  const std::string text = text_of(localization);
  EXPECT_THAT(text, HasSubstr("across: the best place is at the border of the search, so the truth "
                              "may lie outside of it; give a better prior or use --wide\n"));
  EXPECT_THAT(text, HasSubstr("trusted: no, because the best place is at the border\n"));
  EXPECT_THAT(text, Not(HasSubstr("along: ")));
  const nlohmann::json json = json_of(localization);
  EXPECT_EQ(json["trusted"], false);
  EXPECT_EQ(json["at_border"], nlohmann::json::array({false, true, false}));
  EXPECT_EQ(dump_json(json["sigma"][1]), "null");
  EXPECT_EQ(json["evidence_share"], nlohmann::json::array({0.9, 0.0, 0.7}));
  localization.is_wide = true;
  EXPECT_THAT(text_of(localization),
              AllOf(HasSubstr("give a better prior\n"), Not(HasSubstr("--wide"))));
}

TEST(LocalizeReport, TheSigmaOfALowScoreGrowsAsInTheDaemon) {
  MatchResult low = clear_match();
  low.axis_score.x() = 0.0;
  MatchResult grown = clear_match();
  grown.covariance(0, 0) *= EvidenceMonitor::kMaxGrowth * EvidenceMonitor::kMaxGrowth;
  const nlohmann::json json = json_of(localization_of(low));
  EXPECT_NEAR(json["sigma"][0], pose_sigma(grown).x(), 1e-12);
  EXPECT_NEAR(json["sigma"][1], pose_sigma(grown).y(), 1e-12);
}

TEST(LocalizeReport, SaysWhyAMatchIsNotTrusted) {
  MatchResult match = clear_match();
  match.score = 0.99 * EvidenceMonitor::kMinScore;
  match.evidence_share.y() = match.evidence_share.z() = -0.3;
  match.rival_peak.y() = 0.9;
  EXPECT_THAT(
      text_of(localization_of(match)),
      HasSubstr("trusted: no, because the score is too low, the lines do not show the place "
                "across, the lines do not show the yaw, two places across look alike\n"));
}

TEST(LocalizeReport, WithoutEvidenceNothingIsSaid) {
  const Localization localization = localization_of(MatchResult());
  EXPECT_THAT(text_of(localization), HasSubstr("no evidence"));
  const nlohmann::json json = json_of(localization);
  EXPECT_EQ(json["trusted"], false);
  for (const char* key : {"sigma", "at_border", "rival_peak"}) EXPECT_TRUE(json[key].is_null());
}

TEST(LocalizeReport, TooFewCamerasAreNotTrusted) {
  Localization localization = localization_of(clear_match());
  localization.cameras = CameraMask(0b11);
  EXPECT_FALSE(localization.is_trusted());
  EXPECT_EQ(json_of(localization)["trusted"], false);
  EXPECT_THAT(text_of(localization),
              HasSubstr("trusted: no, because fewer than 3 cameras were used\n"));
  localization.cameras.set(2);
  EXPECT_TRUE(localization.is_trusted());
}

TEST(LocalizeReport, AnAnswerWithoutASigmaIsNotWithinThree) {
  PriorScores scores;
  scores.priors.resize(2);
  scores.matches.resize(2);
  scores.matches[0].error = {5.0, 0.0, 0.0};
  scores.matches[0].sigma = {kNotGiven, 0.1, 0.1};
  scores.matches[1].error = {1.0, 0.0, 0.0};
  scores.matches[1].sigma = {0.1, 0.1, 0.1};
  EXPECT_THAT(text_of(scores), AllOf(HasSubstr("errors within 3 sigma, %   0 100 100\n"),
                                     HasSubstr("answers without a sigma    1   0   0\n")));
  const nlohmann::json json = json_of(scores);
  EXPECT_EQ(json["bevloc"]["coverage_3s"], nlohmann::json::array({0.0, 1.0, 1.0}));
  EXPECT_EQ(json["without_sigma"], nlohmann::json::array({1, 0, 0}));
}

TEST(LocalizeReport, WithoutEvidenceNoAxisHasASigma) {
  EXPECT_THAT(sigma_of(localization_of(MatchResult())), testing::Each(testing::IsNan()));
  EXPECT_DOUBLE_EQ(sigma_of(localization_of(clear_match()))[1], pose_sigma(clear_match()).y());
}

}  // namespace
}  // namespace bevloc::evaluation
