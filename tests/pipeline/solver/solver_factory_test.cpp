#include "pipeline/solver/solver_factory.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bevloc {
namespace {

using testing::HasSubstr;

std::string error_of(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                     const SolverParameters& parameters) {
  const auto solver = make_solver(SolverKind::kDecoupled, grid, channels, hypotheses, parameters);
  return solver ? "" : solver.error().message;
}

TEST(SolverFactoryTest, KnowsEveryKindByName) {
  for (const SolverKind kind : all_solver_kinds()) {
    EXPECT_EQ(solver_kind_from(name_of(kind)), kind) << name_of(kind);
    EXPECT_TRUE(make_solver(kind, kFeatureGrid, 4, {}, {})) << name_of(kind);
  }
}

TEST(SolverFactoryTest, ListsTheKnownNames) {
  const auto kind = solver_kind_from("fast");
  ASSERT_FALSE(kind);
  EXPECT_THAT(kind.error().message, HasSubstr("\"fast\""));
  EXPECT_THAT(kind.error().message, HasSubstr("full, full-fft, decoupled-literal, "));
}

TEST(SolverFactoryTest, RefusesUnsupportedGridsAndChannels) {
  EXPECT_EQ(error_of(kFeatureGrid, 16, {}, {}), "");
  EXPECT_THAT(error_of(kFeatureGrid, 0, {}, {}), HasSubstr("0 channels"));
  EXPECT_EQ(error_of(kRasterGrid, 16, {}, {}), "");
  EXPECT_THAT(error_of({200, 50, 0.6}, 16, {}, {}), HasSubstr("200 x 50"));
  EXPECT_THAT(error_of({100, 50, 1.2}, 16, {}, {}), HasSubstr("1.2 m"));
  EXPECT_THAT(error_of({0, 50, 0.6}, 16, {}, {}), HasSubstr("0 x 50"));
  EXPECT_THAT(error_of({2, 50, 0.6}, 16, {}, {}), HasSubstr("2 x 50"));
  EXPECT_THAT(error_of({1 << 20, 1 << 20, 1e-6}, 16, {}, {}), HasSubstr("1048576 x 1048576"));
  EXPECT_THAT(error_of(kFeatureGrid, 1 << 30, {}, {}), HasSubstr("1073741824 channels"));
}

TEST(SolverFactoryTest, TheLiteralSolverNeedsAGridThatItsTransformSupports) {
  const auto make = [](const BevGrid& grid) {
    return make_solver(SolverKind::kDecoupledLiteral, grid, 4, {}, {});
  };
  EXPECT_TRUE(make(kRasterGrid));
  const auto refused = make({90, 50, 0.6});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("90 x 50"));
}

/// A range of 3 m is more cells of 1e-9 m than an int counts.
TEST(SolverFactoryTest, EverySolverRefusesCellsThatAreTooSmall) {
  for (const SolverKind kind : all_solver_kinds()) {
    for (const double cell_m : {0.0, 1e-300, 1e-9, 2.9e-9, 0.0009}) {
      const auto solver = make_solver(kind, {100, 50, cell_m}, 4, {}, {});
      ASSERT_FALSE(solver) << name_of(kind) << " " << cell_m;
      EXPECT_THAT(solver.error().message, HasSubstr("100 x 50")) << name_of(kind);
    }
  }
}

TEST(SolverFactoryTest, OnlySolversWithAFixedTransformSizeLimitTheCells) {
  for (const SolverKind kind : all_solver_kinds()) {
    const bool decoupled = kind == SolverKind::kDecoupled || kind == SolverKind::kDecoupledRefined;
    for (const BevGrid& grid : {BevGrid{200, 160, 0.35}, BevGrid{100, 50, 0.7}}) {
      EXPECT_EQ(make_solver(kind, grid, 1, {}, {}).has_value(), !decoupled)
          << name_of(kind) << " on cells of " << grid.cell_m << " m";
    }
  }
}

TEST(SolverFactoryTest, RefusesGridsThatWouldExhaustTheMemory) {
  for (const SolverKind kind :
       {SolverKind::kFull, SolverKind::kFullFft, SolverKind::kBandedRefined, SolverKind::kBlock}) {
    for (const BevGrid& grid : {BevGrid{200, 100, 0.6}, BevGrid{2, 50, 0.6}, BevGrid{9, 9, 1e-6}}) {
      const auto solver = make_solver(kind, grid, 4, {}, {});
      ASSERT_FALSE(solver) << name_of(kind);
      EXPECT_THAT(solver.error().message, HasSubstr("sides of at most 80 m")) << name_of(kind);
    }
  }
}

TEST(SolverFactoryTest, RefusesInvalidHypotheses) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of(kFeatureGrid, 16, {.x_m = {2.0, 0.0}}, {}), HasSubstr("x: found range 2"));
  EXPECT_THAT(error_of(kFeatureGrid, 16, {.y_m = {nan, 0.2}}, {}), HasSubstr("y: found range nan"));
  EXPECT_THAT(error_of(kFeatureGrid, 16, {.x_m = {50.0, 0.2}}, {}), HasSubstr("x: found range 50"));
  EXPECT_THAT(error_of(kFeatureGrid, 16, {.yaw_rad = {1.0, 0.1}}, {}),
              HasSubstr("yaw: found range 1"));
  EXPECT_THAT(error_of(kFeatureGrid, 16, {.x_m = {2.0, 1e-300}}, {}),
              HasSubstr("x: found range 2"));
  EXPECT_THAT(error_of(kFeatureGrid, 16, {.x_m = {2.0, 0.002}, .y_m = {1.0, 0.002}}, {}),
              HasSubstr("in all"));
}

TEST(SolverFactoryTest, RefusesInvalidParameters) {
  EXPECT_THAT(error_of(kFeatureGrid, 16, {}, {.joint_scale = -1.0F}), HasSubstr("joint_scale"));
  EXPECT_THAT(
      error_of(kFeatureGrid, 16, {}, {.yaw_scale = std::numeric_limits<float>::quiet_NaN()}),
      HasSubstr("yaw_scale"));
  EXPECT_THAT(error_of(kFeatureGrid, 16, {}, {.gem_omega = 3.0F}), HasSubstr("gem_omega: found 3"));
}

}  // namespace
}  // namespace bevloc
