// The JSON that `bevloc draw solver` writes for script/figures.
#include "evaluation/solver/solver_figures.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pipeline/bev_grid.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::Ge;
using testing::HasSubstr;
using testing::Le;
using testing::SizeIs;

namespace fs = std::filesystem;
using Curve = std::vector<double>;
using Plane = std::vector<Curve>;

/// The data of one scene, written once for all tests.
class SolverFiguresTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const test::TemporaryFolder folder;
    const fs::path file = folder / "figures.json";
    const Status status = write_solver_figures(0, file.string());
    ASSERT_TRUE(status) << status.error().message;
    std::ifstream stream(file);
    data_ = new nlohmann::json(nlohmann::json::parse(stream));
  }
  static void TearDownTestSuite() { delete data_; }

  static void expect_planes(const nlohmann::json& planes, const BevGrid& grid) {
    EXPECT_THAT(planes.get<std::vector<Plane>>(),
                AllOf(SizeIs(3), Each(SizeIs(grid.rows)), Each(Each(SizeIs(grid.cols)))));
  }

  /// Planes on kRasterGrid with values from 0 to 255, some of them large.
  static void expect_bytes(const nlohmann::json& planes) {
    expect_planes(planes, kRasterGrid);
    const auto values = planes.get<std::vector<Plane>>();
    EXPECT_THAT(values, Each(Each(Each(AllOf(Ge(0.0), Le(255.0))))));
    EXPECT_THAT(values, Contains(Contains(Contains(Ge(200.0)))));
  }

  /// The hypothesis with the highest score.
  static double best(const Curve& scores, const Curve& hypotheses) {
    EXPECT_EQ(scores.size(), hypotheses.size());
    return hypotheses.at(static_cast<size_t>(std::ranges::max_element(scores) - scores.begin()));
  }

  static const nlohmann::json& data() { return *data_; }

 private:
  static nlohmann::json* data_;
};
nlohmann::json* SolverFiguresTest::data_ = nullptr;

TEST_F(SolverFiguresTest, SpectraHaveThreeViewsWhoseScoresPeakAtTheTurn) {
  const auto& spectra = data()["spectra"];
  EXPECT_EQ(data()["scene"], 0);
  EXPECT_EQ(spectra["turn_deg"], 10.0);
  EXPECT_EQ(spectra["shift_m"], 5.0);
  EXPECT_THAT(spectra["band_edges_per_m"], SizeIs(9));
  ASSERT_THAT(spectra["views"], SizeIs(3));
  const Curve hypotheses = spectra["hypotheses_deg"];
  std::vector<double> turns;
  for (const auto& view : spectra["views"]) {
    expect_bytes(view["raster"]);
    EXPECT_THAT(view["log_amplitude"].get<Plane>(), AllOf(SizeIs(128), Each(SizeIs(128))));
    EXPECT_EQ(view["signature"].size(), spectra["angles_deg"].size());
    turns.push_back(best(view["score"], hypotheses));
  }
  EXPECT_NEAR(turns[0], 0.0, 1e-9);
  EXPECT_NEAR(turns[1], 10.0, 2.0);
  EXPECT_NEAR(turns[2], 10.0, 5.0);
}

TEST_F(SolverFiguresTest, AmplitudesAreAPointReflection) {
  const Plane amplitude = data()["spectra"]["views"][0]["log_amplitude"];
  for (const size_t row : {10U, 50U, 64U, 100U}) {
    for (const size_t col : {3U, 64U, 90U}) {
      EXPECT_NEAR(amplitude[row][col], amplitude[128 - row][128 - col], 2e-4);
    }
  }
}

TEST_F(SolverFiguresTest, AxisScoresPeakAtTheShiftBackToTheMap) {
  const auto& axes = data()["axis_features"];
  const Curve hypotheses = axes["hypotheses_m"];
  EXPECT_THAT(axes["channels"].get<std::vector<std::string>>(),
              ElementsAre("divider", "crossing", "boundary"));
  ASSERT_THAT(axes["perceived"], SizeIs(2));
  for (const auto& side : {axes["map"], axes["perceived"][0], axes["perceived"][1]}) {
    expect_planes(side["features"], kFeatureGrid);
    EXPECT_THAT(side["x_profile"].get<Plane>(), AllOf(SizeIs(3), Each(SizeIs(axes["x_m"].size()))));
    EXPECT_THAT(side["y_profile"].get<Plane>(), AllOf(SizeIs(3), Each(SizeIs(axes["y_m"].size()))));
    for (const Curve& profile : side["x_profile"].get<Plane>()) {
      EXPECT_NEAR(std::accumulate(profile.begin(), profile.end(), 0.0), 0.0, 1e-6);
    }
  }
  for (const char* score : {"x_score", "y_score"}) {
    EXPECT_NEAR(best(axes["perceived"][0][score], hypotheses), 0.0, 0.3) << score;
    EXPECT_NEAR(best(axes["perceived"][1][score], hypotheses), -2.0, 0.3) << score;
  }
}

TEST_F(SolverFiguresTest, DistributionsSumToOneAndStayInRange) {
  const auto& distributions = data()["distributions"];
  EXPECT_THAT(distributions["solvers"].get<std::vector<std::string>>(),
              ElementsAre("full-fft", "decoupled", "decoupled+refine"));
  ASSERT_THAT(distributions["scenes"], SizeIs(3));
  for (const auto& scene : distributions["scenes"]) {
    expect_bytes(scene["perceived"]);
    expect_bytes(scene["raster_prior"]);
    for (const auto& [name, range] : {std::pair("x_m", 2.0), {"y_m", 1.0}, {"yaw_deg", 2.0}}) {
      const auto& axis = scene["axes"][name];
      EXPECT_LE(std::abs(axis["truth"].get<double>()), range) << name;
      EXPECT_NEAR(axis["hypotheses"].back(), range, 1e-9) << name;
      ASSERT_THAT(axis["solutions"], SizeIs(3));
      for (const auto& solution : axis["solutions"]) {
        const Curve probability = solution["probability"];
        EXPECT_EQ(probability.size(), axis["hypotheses"].size());
        EXPECT_NEAR(std::accumulate(probability.begin(), probability.end(), 0.0), 1.0, 1e-4);
        EXPECT_LE(std::abs(solution["mean"].get<double>()), range);
        EXPECT_GT(solution["sigma"], 0.0);
      }
    }
  }
}

TEST(SolverFigures, NameAFileThatCannotBeWritten) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "no_folder/figures.json";
  const Status status = write_solver_figures(0, file.string());
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr(file.string()));
}

}  // namespace
}  // namespace bevloc::evaluation
