#include "pipeline/network/cpu_isa.h"

#include <gtest/gtest.h>

namespace bevloc {
namespace {

constexpr uint32_t kLeaf7WithAmx = 0x23c14010;  // seen on a virtual machine that hides leaf 0x1D
constexpr uint32_t kLeaf7WithoutAmx = kLeaf7WithAmx & ~0x03400000U;

TEST(CpuIsa, AmxWithoutItsLeafIsBroken) {
  EXPECT_TRUE(amx_is_broken({.highest_leaf = 0x1C, .leaf7_edx = kLeaf7WithAmx, .palettes = 0}));
}

TEST(CpuIsa, AmxWithoutPalettesIsBroken) {
  EXPECT_TRUE(amx_is_broken({.highest_leaf = 0x20, .leaf7_edx = kLeaf7WithAmx, .palettes = 0}));
}

TEST(CpuIsa, AmxWithPalettesIsUsable) {
  EXPECT_FALSE(amx_is_broken({.highest_leaf = 0x20, .leaf7_edx = kLeaf7WithAmx, .palettes = 1}));
}

TEST(CpuIsa, NoAmxIsNotBroken) {
  EXPECT_FALSE(amx_is_broken({.highest_leaf = 0x10, .leaf7_edx = kLeaf7WithoutAmx, .palettes = 0}));
}

TEST(CpuIsa, CapHoldsForTheProcess) {
  ASSERT_TRUE(cap_cpu_isa(IsaCap::kAvx2));
  EXPECT_TRUE(cap_cpu_isa(IsaCap::kAvx2));
  const Status other = cap_cpu_isa(IsaCap::kBest);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().message,
            "the network's instruction set is settled in this process already, wanted another");
  EXPECT_FALSE(has_exact_int8_products());
}

}  // namespace
}  // namespace bevloc
