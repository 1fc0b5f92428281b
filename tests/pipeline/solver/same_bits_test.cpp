// The solvers give the same bits on every processor: a recording of a vehicle's arm64 is replayed
// on a developer's x86-64 with the same poses, and figures do not depend on the machine that
// measured them.
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common/crc32.h"
#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/solver/golden_scenes.h"

namespace bevloc {
namespace {

/// The CRC-32 of what each kind answers to the golden scenes. Whoever changes the arithmetic of a
/// solver copies the values that the test prints.
const std::map<SolverKind, uint32_t> kAnswers{
    {SolverKind::kDecoupledRefined, 0xBDA6A1DA},
    {SolverKind::kBanded, 0x5032DB98},
    {SolverKind::kBandedRefined, 0x44A96538},
    {SolverKind::kBlockRefined, 0x50378BC9},
};

class SameBits : public ::testing::TestWithParam<std::pair<const SolverKind, uint32_t>> {};

void append_bytes(const std::vector<float>& values, std::string& bytes) {
  for (const float value : values) {
    std::array<char, sizeof(float)> raw;
    std::memcpy(raw.data(), &value, raw.size());
    bytes.append(raw.data(), raw.size());
  }
}

TEST_P(SameBits, OnEveryProcessor) {
  const auto [kind, answer] = GetParam();
  const auto bev = test::read_npy_floats(test::golden("solver/scenes_bev.npy"));
  const auto map = test::read_npy_floats(test::golden("solver/scenes_map.npy"));
  const int channels = static_cast<int>(bev.shape.at(1));
  auto solver = make_solver(kind, kFeatureGrid, channels, {}, {});
  ASSERT_TRUE(solver) << solver.error().message;
  std::string bytes;
  for (size_t i = 0; i < bev.shape.at(0); ++i) {
    const SolverResult result = test::solve_sample(**solver, bev, map, i);
    ASSERT_EQ(result.evidence, Evidence::kGood);
    append_bytes(test::distributions(result), bytes);
    const Eigen::Vector3f sigma = result.covariance.diagonal().cwiseSqrt().cast<float>();
    append_bytes(
        {static_cast<float>(result.correction.x_m), static_cast<float>(result.correction.y_m),
         static_cast<float>(result.correction.yaw_rad), sigma.x(), sigma.y(), sigma.z()},
        bytes);
  }
  EXPECT_EQ(crc32(bytes), answer) << "of " << name_of(kind);
}

INSTANTIATE_TEST_SUITE_P(Kinds, SameBits, ::testing::ValuesIn(kAnswers));

}  // namespace
}  // namespace bevloc
