#include "evaluation/campaign/campaign_inputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/campaign/campaign_command.h"
#include "evaluation/campaign/integrity_command.h"
#include "tests/evaluation/refusal.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;

TEST(CampaignInputsTest, MeasuredMatchesBelongToTheStageLevel) {
  const std::string wanted = "--matches: found x.csv with --level pictures, wanted --level stage";
  EXPECT_THAT(
      test::refusal_of<CampaignCommand>({"campaign", "--level", "pictures", "--matches", "x.csv"}),
      HasSubstr(wanted));
  EXPECT_THAT(test::refusal_of<IntegrityCommand>(
                  {"integrity", "--matches", "x.csv", "--level", "pictures"}),
              HasSubstr(wanted));
}

}  // namespace
}  // namespace bevloc::evaluation
