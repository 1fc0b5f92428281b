#include "sim/samples/nuisances.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bevloc::sim {
namespace {

TEST(NuisanceSets, AreFoundByTheirNames) {
  for (const NuisanceSet set : all_nuisance_sets()) {
    const auto found = nuisance_set_from(name_of(set));
    ASSERT_TRUE(found) << name_of(set);
    EXPECT_EQ(*found, set);
    EXPECT_FALSE(describe(set).empty());
  }
}

TEST(NuisanceSets, AnUnknownNameFailsWithAListOfTheKnownNames) {
  const auto found = nuisance_set_from("snow");
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().message, testing::HasSubstr("snow"));
  for (const NuisanceSet set : all_nuisance_sets()) {
    EXPECT_THAT(found.error().message, testing::HasSubstr(std::string(name_of(set))));
  }
}

}  // namespace
}  // namespace bevloc::sim
