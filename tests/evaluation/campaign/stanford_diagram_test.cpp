#include "evaluation/campaign/stanford_diagram.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "evaluation/campaign/run_outcome.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;

JudgedCycle cycle_at(double time_s, bool has_pose) {
  JudgedCycle cycle;
  cycle.time_s = time_s;
  if (has_pose) cycle.pose.emplace().protection = {0.5, 0.25, radians(1.0)};
  return cycle;
}

TEST(StanfordDiagramTest, CountsFromTheFirstPoseOfEachDriveOn) {
  StanfordDiagram diagram;
  for (int drive = 0; drive < 2; ++drive) {
    diagram.begin_drive();
    diagram.add(cycle_at(0.0, false));
    diagram.add(cycle_at(0.01, true));
    diagram.add(cycle_at(0.02, false));
    diagram.add(cycle_at(0.03, true));
  }
  EXPECT_EQ(diagram.cycles(), 6U);
  EXPECT_EQ(diagram.valid(), 4U);
  EXPECT_EQ(diagram.protection().available[0], 4U);
}

TEST(StanfordDiagramTest, ASilentApplianceHasNoPose) {
  StanfordDiagram diagram;
  diagram.begin_drive();
  diagram.add(cycle_at(1.0, true));
  diagram.add(cycle_at(4.0, true));
  EXPECT_EQ(diagram.cycles(), 301U);
  EXPECT_EQ(diagram.valid(), 2U);
  diagram.begin_drive();
  diagram.add(cycle_at(9.0, true));
  EXPECT_EQ(diagram.cycles(), 302U) << "a drive has nothing to do with the one before";
}

TEST(StanfordDiagramTest, CountsAsARunDoes) {
  StanfordDiagram diagram;
  diagram.begin_drive();
  RunJudge judge({10.0, 15.0}, {});
  double time_s = 0.0;
  for (const double error_m : {0.2, -0.3, 0.6}) {  // the level is 0.25 m, the alert limit 0.5 m
    JudgedCycle cycle = cycle_at(time_s, true);
    cycle.pose->error.y() = error_m;
    diagram.add(cycle);
    judge.add(cycle);
    time_s += 0.01;
  }
  const ProtectionCounts& counted = diagram.protection();
  EXPECT_EQ(counted.with_level, (PoseCounts{3, 3, 3}));
  EXPECT_EQ(counted.misleading, (PoseCounts{0, 2, 0}));
  EXPECT_EQ(counted.hazardous, (PoseCounts{0, 1, 0}));
  const ProtectionCounts run = judge.outcome().protection;
  EXPECT_EQ(run.misleading, counted.misleading);
  EXPECT_EQ(run.hazardous, counted.hazardous);
  EXPECT_EQ(run.available, counted.available);
  EXPECT_NEAR(diagram.axis(1).worst_excess, 0.35, 1e-12);
}

TEST(StanfordDiagramTest, SaysHowManyDrivesHadAPose) {
  std::vector<NamedDiagram> diagrams{{"no fault", {}}, {"with faults", {}}};
  StanfordDiagram& diagram = diagrams[1].diagram;
  for (const bool has_pose : {true, false, true}) {
    diagram.begin_drive();
    diagram.add(cycle_at(0.0, has_pose));
    diagram.add(cycle_at(0.01, has_pose));
  }
  const std::string table = to_table(diagrams);
  EXPECT_THAT(table, HasSubstr("\nno fault: 0 of 0 drives had a pose\n"));
  EXPECT_THAT(table, HasSubstr("\nwith faults: 2 of 3 drives had a pose\n"));
  const auto json = nlohmann::json::parse(to_json(diagrams));
  EXPECT_EQ(json[1]["drives"], 3);
  EXPECT_EQ(json[1]["drives_with_pose"], 2);
}

}  // namespace
}  // namespace bevloc::evaluation
