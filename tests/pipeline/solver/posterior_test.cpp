#include "pipeline/solver/posterior.h"

#include <cmath>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

constexpr HypothesisAxis kAxis{1.0, 0.25};

std::vector<float> normal(double mean, double sigma) {
  std::vector<double> scores;
  for (int i = 0; i < kAxis.count(); ++i) {
    scores.push_back(-0.5 * std::pow((kAxis.value(i) - mean) / sigma, 2));
  }
  std::vector<float> probability(scores.size());
  softmax(scores, 1.0, probability);
  return probability;
}

TEST(PosteriorTest, TheParabolaFindsTheMeanOfANormalDistribution) {
  for (const double mean : {-0.61, 0.0, 0.13, 0.7}) {
    EXPECT_NEAR(parabola_vertex(normal(mean, 0.3), kAxis), mean, 1e-4);
  }
}

TEST(PosteriorTest, TheParabolaStaysAtTheEndAndOnAPlateau) {
  EXPECT_EQ(parabola_vertex(normal(3.0, 0.3), kAxis), 1.0);
  const std::vector<float> flat(kAxis.count(), 1.0F / 9.0F);
  EXPECT_TRUE(std::isfinite(parabola_vertex(flat, kAxis)));
  std::vector<float> certain(kAxis.count(), 0.0F);
  certain[3] = 1.0F;
  EXPECT_NEAR(parabola_vertex(certain, kAxis), kAxis.value(3), 1e-9);
}

TEST(PosteriorTest, TheEdgeMassIsTheProbabilityWithinOneStepOfTheBorder) {
  std::vector<float> probability(kAxis.count(), 0.0F);
  probability[2] = 0.25F;
  probability[6] = 0.25F;
  EXPECT_EQ(edge_mass(probability), 0.0);
  probability[1] = 0.125F;
  probability[8] = 0.375F;
  EXPECT_EQ(edge_mass(probability), 0.5);
  // An axis of three hypotheses has none that is farther from the border.
  EXPECT_EQ(edge_mass(std::vector<float>{0.25F, 0.5F, 0.25F}), 1.0);
}

TEST(PosteriorTest, ADependentAxisIsConvolvedWithTheSearchedAxis) {
  constexpr HypothesisAxis kSearched{0.5, 0.5};
  const std::vector<float> searched{0.25F, 0.5F, 0.25F};
  std::vector<float> probability(kAxis.count(), 0.0F);
  probability[4] = 1.0F;
  std::vector<float> scratch;
  // The three searched hypotheses shift the peak by half a step to the left, by 0 and to the right.
  convolve({searched, kSearched, 0.0, 0.25}, kAxis, scratch, probability);
  EXPECT_EQ(probability,
            (std::vector<float>{0.0F, 0.0F, 0.0F, 0.125F, 0.75F, 0.125F, 0.0F, 0.0F, 0.0F}));
  // Starts at one end and shifts far beyond the other end.
  convolve({searched, kSearched, -0.5, 8.0}, kAxis, scratch, probability);
  EXPECT_FLOAT_EQ(probability[4], 0.25F * 0.75F);
  EXPECT_FLOAT_EQ(probability.back(), 0.75F);
}

TEST(PosteriorTest, RedistributesTheProbabilityOfTheChosen) {
  std::vector<float> probability{0.1F, 0.4F, 0.2F, 0.3F};
  redistribute(std::vector<int>{1, 3}, std::vector<double>{2.0, 2.0 + std::log(6.0)}, 1.0,
               probability);
  EXPECT_FLOAT_EQ(probability[0], 0.1F);
  EXPECT_FLOAT_EQ(probability[1], 0.1F);
  EXPECT_FLOAT_EQ(probability[2], 0.2F);
  EXPECT_FLOAT_EQ(probability[3], 0.6F);
  // The scale multiplies the scores. A single hypothesis keeps its probability.
  redistribute(std::vector<int>{0, 1}, std::vector<double>{0.0, std::log(3.0)}, 2.0, probability);
  EXPECT_FLOAT_EQ(probability[0], 0.02F);
  EXPECT_FLOAT_EQ(probability[1], 0.18F);
  redistribute(std::vector<int>{2}, std::vector<double>{-0.7}, 500.0, probability);
  EXPECT_FLOAT_EQ(probability[2], 0.2F);
}

TEST(PosteriorTest, ARivalIsAnotherPeakNotANeighbour) {
  EXPECT_EQ(rival_peak(normal(0.1, 0.3)), 0.0);
  EXPECT_NEAR(rival_peak(std::vector<float>{0.1F, 0.4F, 0.1F, 0.1F, 0.3F}), 0.75, 1e-6);
  EXPECT_NEAR(rival_peak(std::vector<float>{0.3F, 0.1F, 0.1F, 0.1F, 0.4F}), 0.75, 1e-6);
  EXPECT_EQ(rival_peak(std::vector<float>{0.2F, 0.2F, 0.2F, 0.2F, 0.2F}), 0.0);
  EXPECT_NEAR(rival_peak(std::vector<float>{0.4F, 0.1F, 0.4F, 0.1F}), 1.0, 1e-6);
}

}  // namespace
}  // namespace bevloc
