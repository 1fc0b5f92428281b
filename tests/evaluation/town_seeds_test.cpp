// No command judges a town that networks train on.
#include "evaluation/town_seeds.h"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/calib/calib_evaluation.h"
#include "evaluation/campaign/campaign_command.h"
#include "evaluation/campaign/integrity_command.h"
#include "evaluation/campaign/tune_matches_command.h"
#include "evaluation/solver/solver_command.h"
#include "tests/evaluation/refusal.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;

constexpr uint64_t kLastTown = sim::kFirstTrainingSeed - 1;

TEST(TownSeeds, EndBeforeThoseOfTraining) {
  EXPECT_TRUE(check_town_seeds("--seed", kLastTown));
  EXPECT_TRUE(check_town_seeds("--seed", 0, sim::kFirstTrainingSeed));
  EXPECT_TRUE(check_town_seeds("--seed", kLastTown - 9, 10));
  for (const auto& [first, count] : std::vector<std::pair<uint64_t, uint64_t>>{
           {kLastTown + 1, 1}, {kLastTown, 2}, {kLastTown - 8, 10}, {0, kLastTown + 2}}) {
    EXPECT_FALSE(check_town_seeds("--seed", first, count)) << first << ", " << count;
  }
  EXPECT_EQ(check_town_seeds("--first-seed", kLastTown, 3).error().message,
            "--first-seed: found the town 4294967297, wanted seeds below 4294967296, because "
            "networks train on the others");
  EXPECT_THAT(check_town_seeds("--seed", ~uint64_t{0}, 2).error().message,
              HasSubstr("found the town 18446744073709551615"));
}

template <typename Command>
std::string refusal_from_last_town(std::vector<std::string> words) {
  words.insert(words.end(), {"--first-seed", std::to_string(kLastTown)});
  return test::refusal_of<Command>(std::move(words));
}

TEST(TownSeeds, AreCheckedForAllDrives) {
  const test::TemporaryFolder folder;
  const std::string csv = folder / "matches.csv";
  for (const std::string& refusal :
       {refusal_from_last_town<CampaignCommand>({"campaign", "--seeds", "2"}),
        refusal_from_last_town<IntegrityCommand>({"integrity", "--drives", "2"}),
        refusal_from_last_town<CalibEvaluation>({"calib", "--drives", "2"}),
        refusal_from_last_town<TuneMatchesCommand>({"matches", "--drives", "2", "--csv", csv})}) {
    EXPECT_THAT(refusal, HasSubstr("--first-seed: found the town 4294967296"));
  }
}

TEST(TownSeeds, OfAnEvaluationOfSolversStayWithTheirSeed) {
  const auto parse = [](const std::string& scenes) {
    CLI::App eval;
    CLI::App tune;
    SolverCommand command;
    command.declare(eval, tune);
    eval.parse("solver --scenes " + scenes);
  };
  EXPECT_NO_THROW(parse("40960"));
  EXPECT_THROW(parse("40961"), CLI::ValidationError) << "they would take scenes of the next seed";
}

}  // namespace
}  // namespace bevloc::evaluation
