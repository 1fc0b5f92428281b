// The evaluation of solvers: its measures and its output.
#include "evaluation/solver/solver_evaluation.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/heap_use.h"
#include "evaluation/solver/mask_scales.h"
#include "evaluation/solver/paper_tables.h"
#include "evaluation/solver/read_out_case.h"
#include "evaluation/solver/scale_tuning.h"
#include "evaluation/solver/solver_report.h"
#include "evaluation/summary_format.h"
#include "pipeline/solver/posterior.h"
#include "sim/perception/matching_scene.h"

namespace bevloc::evaluation {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::Ge;
using testing::HasSubstr;
using testing::Le;

SolverResult certain_of(int x, int y, int yaw, const HypothesisGrid& hypotheses) {
  SolverResult result;
  set_no_evidence(hypotheses, result);
  for (auto* probability :
       {&result.x_probability, &result.y_probability, &result.yaw_probability}) {
    std::ranges::fill(*probability, 0.0F);
  }
  result.x_probability[x] = result.y_probability[y] = result.yaw_probability[yaw] = 1.0F;
  return result;
}

TEST(SolverScore, InterpolatesTheProbability) {
  const HypothesisGrid hypotheses;
  const SolverResult result = certain_of(10, 5, 10, hypotheses);
  const Outcome on_it = judge(result, hypotheses, {0.0, 0.0, 0.0});
  EXPECT_THAT(on_it.nll, Each(DoubleNear(0.0, 1e-6)));
  const Outcome half_way = judge(result, hypotheses, {0.1, -0.1, radians(0.1)});
  EXPECT_THAT(half_way.nll, Each(DoubleNear(std::log(2.0), 1e-6)));
  const Outcome far_off = judge(result, hypotheses, {-2.0, 1.0, radians(-2.0)});
  EXPECT_THAT(far_off.nll, Each(Ge(10.0)));
  EXPECT_TRUE(std::isfinite(far_off.nll[0]));
  const Outcome outside = judge(result, hypotheses, {3.0, 2.0, radians(5.0)});
  EXPECT_TRUE(std::isfinite(outside.nll[0]));
}

TEST(SolverScore, MeasuresErrorsInMetresAndDegrees) {
  const HypothesisGrid hypotheses;
  SolverResult result = certain_of(10, 5, 10, hypotheses);
  result.correction = {1.0, -0.5, radians(1.5)};
  result.parabola = {1.1, -0.4, radians(1.0)};
  result.covariance = Eigen::Vector3d(0.25, 0.04, radians(2.0) * radians(2.0)).asDiagonal();
  const Outcome outcome = judge(result, hypotheses, {0.8, -0.3, radians(1.0)});
  EXPECT_THAT(outcome.error,
              ElementsAre(DoubleNear(0.2, 1e-9), DoubleNear(-0.2, 1e-9), DoubleNear(0.5, 1e-9)));
  EXPECT_THAT(outcome.parabola_error,
              ElementsAre(DoubleNear(0.3, 1e-9), DoubleNear(-0.1, 1e-9), DoubleNear(0.0, 1e-9)));
  EXPECT_THAT(outcome.sigma,
              ElementsAre(DoubleNear(0.5, 1e-9), DoubleNear(0.2, 1e-9), DoubleNear(2.0, 1e-9)));
}

TEST(SolverScore, Summarises) {
  std::vector<Outcome> outcomes(4);
  for (int i = 0; i < 4; ++i) {
    outcomes[i].error = {i - 1.0, 2.0, 0.0};  // -1, 0, 1, 2
    outcomes[i].sigma = {1.0, 0.7, 0.0};
    outcomes[i].nll = {1.0 * i, 0.0, 0.0};
    outcomes[i].time_ms = 10.0 * i;
  }
  const Summary summary = summarise(outcomes);
  EXPECT_EQ(summary.scenes, 4U);
  EXPECT_NEAR(summary.mae[0], 1.0, 1e-12);
  EXPECT_NEAR(summary.rmse[0], std::sqrt(1.5), 1e-12);
  EXPECT_NEAR(summary.nll[0], 1.5, 1e-12);
  EXPECT_NEAR(summary.coverage_1s[0], 0.75, 1e-12);
  EXPECT_NEAR(summary.coverage_1s[1], 0.0, 1e-12);
  EXPECT_NEAR(summary.coverage_3s[1], 1.0, 1e-12);
  EXPECT_NEAR(summary.coverage_1s[2], 1.0, 1e-12);
  EXPECT_EQ(summary.median[0], 1.0);
}

TEST(SolverScore, CountsNoErrorWithoutASigmaAsCovered) {
  std::vector<Outcome> outcomes(3);
  for (Outcome& outcome : outcomes) outcome.error = {0.2, 0.2, 0.2};
  outcomes[0].sigma = {kNotGiven, 0.3, kNotGiven};
  outcomes[1].sigma = {0.1, 0.1, kNotGiven};
  outcomes[2].sigma = {0.3, 0.3, kNotGiven};
  const Summary summary = summarise(outcomes);
  EXPECT_DOUBLE_EQ(summary.coverage_1s[0], 0.5);
  EXPECT_DOUBLE_EQ(summary.coverage_3s[0], 1.0);
  EXPECT_DOUBLE_EQ(summary.coverage_1s[1], 2.0 / 3.0);
  EXPECT_TRUE(std::isnan(summary.coverage_1s[2]));
}

TEST(SolverScore, GivesNoMeasuresWithoutScenes) {
  const Summary summary = summarise({});
  EXPECT_EQ(summary.scenes, 0U);
  EXPECT_EQ(three(summary.mae), "- - -");
  EXPECT_EQ(percent(summary.coverage_3s), "  -   -   -");
  EXPECT_TRUE(std::isnan(summary.time_ms));
}

TEST(SolverScore, MarksMeasuresThatAMethodLacks) {
  Summary summary = summarise({judge(Se2{1.0, 0.0, 0.0}, Se2{}), judge(Se2{0.0, 0.5, 0.0}, Se2{})});
  EXPECT_THAT(summary.mae, ElementsAre(0.5, 0.25, 0.0));
  for (const PerAxis& values :
       {summary.nll, summary.coverage_1s, summary.coverage_3s, summary.parabola_mae}) {
    EXPECT_THAT(values, Each(testing::IsNan()));
  }
  EXPECT_EQ(three(summary.nll), "- - -");
  EXPECT_EQ(percent(summary.coverage_1s), "  -   -   -");
  EXPECT_THAT(csv_values(summary), testing::EndsWith(",,,,,,,,,"));
  EXPECT_TRUE(nlohmann::json::parse(json_of(summary).dump())["nll"][2].is_null());
}

TEST(SolverCases, ContainThePapersRows) {
  EXPECT_EQ(variant_cases().size(), static_cast<size_t>(kSolverKinds));
  std::vector<SolverCase> all = variant_cases();
  for (const auto& more : {table_three_cases(), table_four_cases()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  for (const PaperTable& table : paper_tables()) {
    for (const PaperRow& row : table.rows) {
      for (const SolverKind kind : row.our_solvers) {
        SolverCase ours = row.ours;
        ours.solver = kind;
        EXPECT_THAT(all, testing::Contains(ours)) << table.title << " " << name_of(kind);
      }
    }
  }
}

TEST(SolverCases, EveryCaseCanBeSolved) {
  for (const auto& cases : {variant_cases(), table_three_cases(), table_four_cases()}) {
    for (const SolverCase& c : cases) {
      EXPECT_TRUE(
          make_solver(c.solver, c.grid, c.channels, c.hypotheses(), hand_made_parameters(c)))
          << name_of(c.solver) << " " << size_name(c.grid) << " " << c.channels;
    }
  }
}

TEST(ReadOutCases, ContainAllInputsSizesAndSteps) {
  EXPECT_EQ(read_out_cases(ReadOutRows::kSolvers).size(), 5U);
  EXPECT_TRUE(read_out_cases(ReadOutRows::kBaselines).empty());
  const auto cases = read_out_cases(ReadOutRows::kAll);
  EXPECT_EQ(cases, read_out_cases(ReadOutRows::kVariants));
  std::vector<std::string> labels;
  std::ranges::transform(cases, std::back_inserter(labels), label_of);
  for (const char* wanted :
       {"full-fft", "block S", "decoupled 0.1", "decoupled S 0.4", "decoupled+refine S 400x200",
        "decoupled S 400x200 0.1", "full-fft T"}) {
    EXPECT_THAT(labels, testing::Contains(wanted).Times(1));
  }
  for (const ReadOutCase& read_out : cases) {
    const bool masks = read_out.input != SolverInput::kFeatures;
    EXPECT_TRUE(masks || read_out.solver_case.grid == kFeatureGrid);
    EXPECT_EQ(read_out.solver_case.channels, masks ? 4 : 16);
  }
}

TEST(MaskScalesTest, AreTunedOncePerSolverAndSize) {
  sim::SceneSampler sampler(sim::kTuningSeedBase);
  sim::MatchingScene scene;
  std::vector<TuningSample> samples;
  for (uint64_t i = 0; i < 6; ++i) {
    sampler.make(i, sim::CorruptionLevel::kMild, scene);
    samples.push_back({scene.perceived, {}, scene.raster_prior, scene.correction});
  }
  MaskScales scales(samples, &TuningSample::perceived);
  SolverCase banded{.solver = SolverKind::kBandedRefined, .channels = 4};
  const auto found = scales.parameters_for(banded);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_GT(found->banded_y_scale, 12.0F);
  EXPECT_GT(found->refine_y_scale, 12.0F);
  banded.step_m = 0.4;
  EXPECT_EQ(scales.parameters_for(banded)->refine_y_scale, found->refine_y_scale);
  EXPECT_FALSE(scales.parameters_for({.solver = SolverKind::kBanded, .grid = {7, 3, 0.15}}));
}

/// Whether the memory of the heap is counted, which it is not under a sanitizer.
bool heap_is_counted() {
  return heap_in_use_bytes() > 0;
}

class SolverEvaluationTest : public testing::Test {
 protected:
  static std::vector<CaseResult> evaluate(sim::CorruptionLevel corruption, int scenes) {
    EvaluationOptions options = kOptions;
    options.scenes = scenes;
    options.corruption = corruption;
    const std::vector<SolverCase> cases{{.solver = SolverKind::kFullFft},
                                        {.solver = SolverKind::kBandedRefined},
                                        {.solver = SolverKind::kDecoupled, .channels = 3}};
    std::vector<SolverParameters> parameters;
    for (const SolverCase& c : cases) parameters.push_back(hand_made_parameters(c));
    int last = 0;
    auto results = evaluate_solvers(cases, parameters, options, [&last](int done) {
      EXPECT_EQ(done, last + 1);
      last = done;
    });
    EXPECT_TRUE(results) << results.error().message;
    EXPECT_EQ(last, scenes);
    return *results;
  }

  static constexpr EvaluationOptions kOptions{.seed_base = sim::kTuningSeedBase};
};

TEST_F(SolverEvaluationTest, IsRepeatable) {
  const auto first = evaluate(sim::CorruptionLevel::kPaper, 5);
  const auto second = evaluate(sim::CorruptionLevel::kPaper, 5);
  for (size_t k = 0; k < first.size(); ++k) {
    ASSERT_EQ(first[k].outcomes.size(), 5U);
    EXPECT_GE(first[k].buffer_bytes, heap_is_counted() ? 100'000U : 0U);
    for (size_t i = 0; i < 5; ++i) {
      EXPECT_EQ(first[k].outcomes[i].error, second[k].outcomes[i].error);
      EXPECT_GT(first[k].outcomes[i].time_ms, 0.0);
    }
  }
}

TEST_F(SolverEvaluationTest, IsAccurateOnCleanMasks) {
  const auto results = evaluate(sim::CorruptionLevel::kClean, 20);
  for (const CaseResult& result : results) {
    const Summary summary = summarise(result.outcomes);
    EXPECT_LT(summary.mae[1], 0.15) << name_of(result.solver_case.solver);
    EXPECT_LT(summary.mae[2], 0.4) << name_of(result.solver_case.solver);
  }
}

TEST_F(SolverEvaluationTest, WritesTablesJsonAndCsv) {
  const auto results = evaluate(sim::CorruptionLevel::kMild, 5);
  for (const std::string& table : {accuracy_table(results), cost_table(results)}) {
    for (const char* name : {"full-fft", "banded+refine", "decoupled"}) {
      EXPECT_THAT(table, HasSubstr(name));
    }
  }
  EXPECT_THAT(road_table(results[0]), HasSubstr("straight_solid"));
  EXPECT_THAT(paper_comparison(results), HasSubstr("Table IV"));
  const auto json = nlohmann::json::parse(to_json(results, kOptions, 7));
  ASSERT_EQ(json["rows"].size(), 3U);
  const auto& row = json["rows"][1];
  EXPECT_EQ(row["solver"], "banded+refine");
  EXPECT_EQ(row["size"], "100x50");
  EXPECT_EQ(row["channels"], 16);
  EXPECT_EQ(row["step_m"], 0.2);
  for (const char* key : {"mae", "rmse", "p95", "nll", "coverage_1s", "coverage_3s"}) {
    EXPECT_EQ(row[key].size(), 3U) << key;
    EXPECT_THAT(row[key].get<std::vector<double>>(), Each(Ge(0.0))) << key;
  }
  EXPECT_THAT(row["coverage_1s"].get<std::vector<double>>(), Each(Le(1.0 + 1e-9)));
  EXPECT_GT(row["time_ms"], 0.0);
  EXPECT_GE(row["buffer_bytes"], heap_is_counted() ? 100'000 : 0);
  const std::string csv = to_csv(results);
  EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + 3 * (1 + sim::kRoadKinds));
  const std::string header = csv.substr(0, csv.find('\n'));
  const std::string line =
      csv.substr(header.size() + 1, csv.find('\n', header.size() + 1) - header.size() - 1);
  EXPECT_EQ(std::ranges::count(header, ','), std::ranges::count(line, ','));
}

TEST_F(SolverEvaluationTest, TunedScalesBeatWrongScales) {
  EvaluationOptions options = kOptions;
  options.scenes = 10;
  const SolverCase banded{.solver = SolverKind::kBanded};
  const auto tuned = tune_scales(banded, options);
  ASSERT_TRUE(tuned) << tuned.error().message;
  SolverParameters blunt = *tuned;
  blunt.banded_x_scale = blunt.banded_y_scale = 1.0F;
  const auto results = evaluate_solvers({banded, banded}, {*tuned, blunt}, options, [](int) {});
  ASSERT_TRUE(results);
  EXPECT_LT(summarise((*results)[0].outcomes).nll[1], summarise((*results)[1].outcomes).nll[1]);
  EXPECT_THAT(describe(*tuned), HasSubstr("axes"));
}

}  // namespace
}  // namespace bevloc::evaluation
