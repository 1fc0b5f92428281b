#include "pipeline/tracker/evidence.h"

#include <gtest/gtest.h>

namespace bevloc {
namespace {

MatchResult good_match() {
  MatchResult match;
  match.evidence = Evidence::kGood;
  match.covariance = Eigen::Vector3d(0.04, 0.01, 1e-5).asDiagonal();
  match.score = 0.33;
  match.axis_score = {0.3, 0.4, 0.4};
  return match;
}

Seen judge_repeatedly(EvidenceMonitor& monitor, const MatchResult& match) {
  Seen seen;
  for (int i = 0; i < 20; ++i) {
    MatchResult copy = match;
    seen = monitor.judge(copy);
  }
  return seen;
}

/// The number of good matches until one of them confirms.
int matches_until_confirmed(EvidenceMonitor& monitor) {
  int matches = 0;
  bool confirms = false;
  while (!confirms && matches < 100) {
    MatchResult match = good_match();
    confirms = monitor.judge(match).confirms();
    ++matches;
  }
  return matches;
}

TEST(EvidenceTest, AGoodMatchConfirmsAfterSomeFrames) {
  EvidenceMonitor monitor;
  EXPECT_GT(matches_until_confirmed(monitor), 1) << "one frame is not enough";
  EXPECT_TRUE(judge_repeatedly(monitor, good_match()).confirms_start());
}

TEST(EvidenceTest, AWrongPlaceConfirmsNothing) {
  EvidenceMonitor monitor;
  MatchResult wrong = good_match();
  wrong.score = 0.11;  // the median 3 m to the side
  EXPECT_FALSE(judge_repeatedly(monitor, wrong).confirms());
}

TEST(EvidenceTest, DarkCamerasEndTheConfirmation) {
  EvidenceMonitor monitor;
  judge_repeatedly(monitor, good_match());
  EXPECT_FALSE(judge_repeatedly(monitor, MatchResult()).place);
  EvidenceMonitor fresh;
  EXPECT_EQ(matches_until_confirmed(monitor), matches_until_confirmed(fresh));
}

TEST(EvidenceTest, AnAnswerAtTheBorderIsNoEvidence) {
  EvidenceMonitor monitor;
  judge_repeatedly(monitor, good_match());
  MatchResult match = good_match();
  match.edge_mass.y() = 0.9;
  const Seen seen = monitor.judge(match);
  EXPECT_TRUE(seen.at_border.y());
  EXPECT_FALSE(seen.across);
  forget_border(seen, match);
  EXPECT_EQ(match.evidence_share.y(), 0.0);
  EXPECT_EQ(match.evidence_share.x(), 1.0);
}

TEST(EvidenceTest, TwoPlacesThatLookAlikeConfirmNoStart) {
  EvidenceMonitor monitor;
  MatchResult match = good_match();
  match.rival_peak.y() = 0.9;
  const Seen seen = judge_repeatedly(monitor, match);
  EXPECT_TRUE(seen.confirms());
  EXPECT_FALSE(seen.confirms_start());
}

TEST(EvidenceTest, WidensAnAxisWithALowScore) {
  EvidenceMonitor monitor;
  MatchResult match = good_match();
  match.axis_score.x() = 0.06;
  monitor.judge(match);
  EXPECT_NEAR(match.covariance(0, 0), 4.0 * good_match().covariance(0, 0), 1e-12);
  EXPECT_EQ(match.covariance(1, 1), good_match().covariance(1, 1));
}

TEST(EvidenceTest, ASingleMatchIsJudgedByItsOwnScore) {
  MatchResult match = good_match();
  EXPECT_TRUE(EvidenceMonitor::judge_alone(match).confirms_start());
  match.score = 0.99 * EvidenceMonitor::kMinScore;
  EXPECT_FALSE(EvidenceMonitor::judge_alone(match).place);
  match = good_match();
  match.axis_score.z() = 0.06;
  match.edge_mass.y() = 0.9;
  const Seen seen = EvidenceMonitor::judge_alone(match);
  EXPECT_TRUE(seen.at_border.y());
  EXPECT_FALSE(seen.across);
  EXPECT_NEAR(match.covariance(2, 2), 4.0 * good_match().covariance(2, 2), 1e-12);
  MatchResult none;
  EXPECT_FALSE(EvidenceMonitor::judge_alone(none).confirms());
}

TEST(EvidenceTest, TheGrowthFollowsTheScoreUpToALimit) {
  EXPECT_EQ(EvidenceMonitor::growth_of(0.3), 1.0);
  EXPECT_NEAR(EvidenceMonitor::growth_of(0.06), 2.0, 1e-12);
  EXPECT_EQ(EvidenceMonitor::growth_of(0.0), EvidenceMonitor::kMaxGrowth);
  EXPECT_EQ(EvidenceMonitor::growth_of(-0.2), EvidenceMonitor::kMaxGrowth);
}

}  // namespace
}  // namespace bevloc
