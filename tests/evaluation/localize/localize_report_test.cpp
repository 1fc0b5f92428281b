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

}  // namespace
}  // namespace bevloc::evaluation
