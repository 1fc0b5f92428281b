// `bevloc eval network`: its measures, its output and the arguments it refuses.
#include "evaluation/network/network_command.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "evaluation/network/network_evaluation.h"
#include "evaluation/solver/read_out_case.h"
#include "tests/support/command_line.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/text.h"

namespace bevloc::evaluation {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::Ge;
using testing::HasSubstr;
using testing::Le;
using testing::StartsWith;

constexpr const char* kModel = BEVLOC_SOURCE_DIR "/models/nano.onnx";
constexpr const char* kMap = BEVLOC_SOURCE_DIR "/tests/pipeline/map/fixtures/street.osm";

Status run(std::vector<std::string> arguments, const std::string& model = kModel) {
  arguments.insert(arguments.begin(), {"network", "--model", model});
  return test::run_command<NetworkCommand>(arguments);
}

class NetworkCommandTest : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_ / name; }

  const test::TemporaryFolder folder_;
};

TEST_F(NetworkCommandTest, WritesARowPerMethod) {
  const Status status = run({"--frames", "4", "--json", file("a.json"), "--csv", file("a.csv")});
  ASSERT_TRUE(status) << status.error().message;
  const auto json = nlohmann::json::parse(test::read_text(file("a.json")));
  EXPECT_EQ(json["model"], "nano");
  EXPECT_EQ(json["scenes"], 4);
  std::vector<std::string> solvers;
  for (const auto& row : json["rows"]) {
    solvers.push_back(row["solver"]);
    EXPECT_EQ(row["set"], "standard");
    EXPECT_EQ(row["scenes"], 4);
    for (const char* key : {"mae", "rmse", "median", "p95", "parabola_mae", "nll", "coverage_1s",
                            "coverage_3s", "iou"}) {
      ASSERT_EQ(row[key].size(), 3U) << key;
      EXPECT_THAT(row[key].get<std::vector<double>>(), Each(Ge(0.0))) << key;
    }
    EXPECT_THAT(row["iou"].get<std::vector<double>>(), Each(Le(1.0)));
  }
  EXPECT_THAT(solvers, ElementsAre("prior", "full-fft", "block", "decoupled", "decoupled+refine",
                                   "banded+refine"));
  std::istringstream csv(test::read_text(file("a.csv")));
  std::string header;
  std::getline(csv, header);
  EXPECT_THAT(header, StartsWith("set,solver,scenes,mae_x_m"));
  for (const std::string& solver : solvers) {
    std::string line;
    std::getline(csv, line);
    EXPECT_THAT(line, StartsWith("standard," + solver + ",4,"));
    EXPECT_EQ(std::ranges::count(line, ','), std::ranges::count(header, ','));
  }
}

TEST_F(NetworkCommandTest, BaselinesHaveErrorsButNoDistribution) {
  ASSERT_TRUE(run(
      {"--frames", "2", "--rows", "baselines", "--json", file("a.json"), "--csv", file("a.csv")}));
  const auto rows = nlohmann::json::parse(test::read_text(file("a.json")))["rows"];
  std::vector<std::string> names;
  for (const auto& row : rows) {
    names.push_back(row["solver"]);
    EXPECT_THAT(row["mae"].get<std::vector<double>>(), Each(Ge(0.0)));
    EXPECT_TRUE(row["input"].is_null());
    for (const char* key : {"nll", "coverage_1s", "coverage_3s", "parabola_mae"}) {
      ASSERT_EQ(row[key].size(), 3U) << key;
      EXPECT_EQ(row[key][0].is_null(), row["solver"] != "prior") << key;
    }
  }
  EXPECT_THAT(names, ElementsAre("prior", "icp", "distance-transform", "ipm"));
  std::istringstream csv(test::read_text(file("a.csv")));
  std::string header;
  std::getline(csv, header);
  for (std::string line; std::getline(csv, line);) {
    EXPECT_EQ(std::ranges::count(line, ','), std::ranges::count(header, ','));
    EXPECT_THAT(line, testing::Not(HasSubstr("nan")));
  }
}

TEST_F(NetworkCommandTest, EverySetHasItsRows) {
  ASSERT_TRUE(run({"--frames", "1", "--set", "all", "--json", file("a.json")}));
  const auto json = nlohmann::json::parse(test::read_text(file("a.json")));
  EXPECT_EQ(json["rows"].size(), 6 * sim::kNuisanceSets);
  EXPECT_EQ(json["rows"].back()["set"], "unsynchronised_uncompensated");
}

TEST_F(NetworkCommandTest, TheSameSeedGivesTheSameRows) {
  const auto rows = [this](const std::string& seed) {
    EXPECT_TRUE(run({"--frames", "2", "--seed", seed, "--json", file("a.json")}));
    return nlohmann::json::parse(test::read_text(file("a.json")))["rows"];
  };
  EXPECT_EQ(rows("3"), rows("3"));
  EXPECT_NE(rows("3"), rows("4"));
}

TEST_F(NetworkCommandTest, DrivesOnAnImportedMap) {
  ASSERT_TRUE(run({"--frames", "2", "--map", kMap, "--json", file("a.json")}));
  EXPECT_EQ(nlohmann::json::parse(test::read_text(file("a.json")))["map"], kMap);
}

constexpr const char* kKerbAlone =
    "<osm version='0.6'><node id='1' lat='49.0' lon='8.0'/><node id='2' lat='49.001' lon='8.0'/>"
    "<way id='3'><nd ref='1'/><nd ref='2'/><tag k='type' v='curbstone'/></way></osm>";

TEST_F(NetworkCommandTest, RefusesBadArgumentsAndFiles) {
  const auto refusal = [](const std::vector<std::string>& arguments,
                          const std::string& model = kModel) {
    const Status status = run(arguments, model);
    return status ? std::string("no error") : status.error().message;
  };
  EXPECT_THAT(refusal({"--set", "snow"}), HasSubstr("snow"));
  EXPECT_THAT(refusal({}, file("none.onnx")), HasSubstr("none.onnx"));
  EXPECT_THAT(refusal({"--map", file("none.osm")}), HasSubstr("none.osm"));
  std::ofstream(file("kerb.osm")) << kKerbAlone;
  EXPECT_THAT(refusal({"--map", file("kerb.osm")}), HasSubstr("found no lanes"));
  EXPECT_THROW(run({"--json", file("none/a.json")}), CLI::ValidationError);
  EXPECT_THROW(run({"--frames", "0"}), CLI::ValidationError);
  EXPECT_THROW(run({"--rows", "table5"}), CLI::ValidationError);
}

TEST_F(NetworkCommandTest, TheProgramExitsWithTwoAndOneLine) {
  const std::string command =
      std::string(BEVLOC_PROGRAM) + " eval network --set snow 2> " + file("err");
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2);
  const std::string message = test::read_text(file("err"));
  EXPECT_THAT(message, StartsWith("bevloc: set: found \"snow\""));
  EXPECT_EQ(std::ranges::count(message, '\n'), 1);
}

class NetworkEvaluationTest : public testing::Test {
 protected:
  static sim::SampleStream stream_of(sim::NuisanceSet set) {
    return {.first_seed = 17, .nuisances = sim::nuisances_of(set), .map = nullptr};
  }

  static SetResult evaluate(sim::NuisanceSet set, int frames) {
    auto evaluation = NetworkEvaluation::create(kModel);
    EXPECT_TRUE(evaluation) << evaluation.error().message;
    int done = 0;
    SetResult result = evaluation->run(stream_of(set), frames, [&done] { ++done; });
    EXPECT_EQ(done, frames);
    return result;
  }
};

TEST_F(NetworkEvaluationTest, ThePriorErrorIsTheCorrectionWithAUniformDistribution) {
  std::vector<PerAxis> errors;
  sim::make_samples_of_world(
      stream_of(sim::NuisanceSet::kClean), 0, 0, [&errors](const sim::Sample& sample) {
        errors.push_back(
            {-sample.correction.x_m, -sample.correction.y_m, degrees(-sample.correction.yaw_rad)});
        return errors.size() < 2;
      });
  const SetResult result = evaluate(sim::NuisanceSet::kClean, 2);
  const ReadOut& prior = result.read_outs.front();
  ASSERT_EQ(prior.name, "prior");
  // There are 21 x 11 x 21 hypotheses.
  const PerAxis uniform_nll{std::log(21.0), std::log(11.0), std::log(21.0)};
  for (size_t i = 0; i < errors.size(); ++i) {
    for (size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(prior.outcomes[i].error[axis], errors[i][axis], 1e-9);
      EXPECT_NEAR(prior.outcomes[i].nll[axis], uniform_nll[axis], 1e-6);
    }
  }
}

TEST_F(NetworkEvaluationTest, TheShippedModelReducesTheLateralError) {
  const SetResult result = evaluate(sim::NuisanceSet::kClean, 8);
  const Summary prior = summarise(result.read_outs.front().outcomes);
  for (size_t k = 1; k < result.read_outs.size(); ++k) {
    const Summary found = summarise(result.read_outs[k].outcomes);
    EXPECT_EQ(found.scenes, 8U);
    EXPECT_LT(found.mae[1], 0.7 * prior.mae[1]) << result.read_outs[k].name;
    EXPECT_LT(found.nll[1], prior.nll[1]) << result.read_outs[k].name;
  }
  EXPECT_GT(result.iou[2], 0.2);
}

TEST_F(NetworkEvaluationTest, VariantsIncludeSolversOnMasks) {
  auto evaluation = NetworkEvaluation::create(kModel, ReadOutRows::kVariants, 1);
  ASSERT_TRUE(evaluation) << evaluation.error().message;
  const SetResult result = evaluation->run(stream_of(sim::NuisanceSet::kClean), 4, [] {});
  const auto cases = read_out_cases(ReadOutRows::kVariants);
  ASSERT_EQ(result.read_outs.size(), 1 + cases.size());
  const Summary prior = summarise(result.read_outs.front().outcomes);
  for (size_t k = 0; k < cases.size(); ++k) {
    const ReadOut& read_out = result.read_outs[k + 1];
    ASSERT_TRUE(read_out.solver_case);
    EXPECT_EQ(*read_out.solver_case, cases[k]);
    EXPECT_LT(summarise(read_out.outcomes).mae[1], prior.mae[1]) << label_of(cases[k]);
  }
}

TEST_F(NetworkEvaluationTest, IsWorseWithoutCameras) {
  sim::SampleStream blind = stream_of(sim::NuisanceSet::kClean);
  blind.nuisances.missing_cameras = {.probability = 1.0, .most = 200};
  auto evaluation = NetworkEvaluation::create(kModel);
  ASSERT_TRUE(evaluation);
  const SetResult result = evaluation->run(blind, 4, [] {});
  const SetResult sighted = evaluation->run(stream_of(sim::NuisanceSet::kClean), 4, [] {});
  EXPECT_LT(result.iou[2], sighted.iou[2]);
  EXPECT_GT(summarise(result.read_outs[1].outcomes).mae[1],
            summarise(sighted.read_outs[1].outcomes).mae[1]);
}

}  // namespace
}  // namespace bevloc::evaluation
