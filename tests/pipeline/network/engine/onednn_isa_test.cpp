// The selection of oneDNN's instruction set.
#include <gtest/gtest.h>

#include "pipeline/network/engine/isa.h"
#include "pipeline/network/model/load_error.h"

namespace bevloc::nn::onednn {
namespace {

constexpr uint32_t kLeaf7WithAmx = 0x23c14010;  // from a virtual machine that hides leaf 0x1D
constexpr uint32_t kLeaf7WithoutAmx = kLeaf7WithAmx & ~0x03400000U;

TEST(OneDnnIsa, AmxWithoutItsLeafIsBroken) {
  EXPECT_TRUE(amx_is_broken({.highest_leaf = 0x1C, .leaf7_edx = kLeaf7WithAmx, .palettes = 0}));
}

TEST(OneDnnIsa, AmxWithoutPalettesIsBroken) {
  EXPECT_TRUE(amx_is_broken({.highest_leaf = 0x20, .leaf7_edx = kLeaf7WithAmx, .palettes = 0}));
}

TEST(OneDnnIsa, AmxWithPalettesIsUsable) {
  EXPECT_FALSE(amx_is_broken({.highest_leaf = 0x20, .leaf7_edx = kLeaf7WithAmx, .palettes = 1}));
}

TEST(OneDnnIsa, NoAmxIsNotBroken) {
  EXPECT_FALSE(amx_is_broken({.highest_leaf = 0x10, .leaf7_edx = kLeaf7WithoutAmx, .palettes = 0}));
}

TEST(OneDnnIsa, CapHoldsForTheProcess) {
#ifndef __x86_64__
  GTEST_SKIP() << "oneDNN has instruction sets to choose from on x86-64 only";
#endif
  cap_cpu_isa(IsaCap::kAvx2);
  EXPECT_NO_THROW(cap_cpu_isa(IsaCap::kAvx2));
  try {
    cap_cpu_isa(IsaCap::kBest);
    FAIL() << "another cap was accepted";
  } catch (const LoadError& error) {
    EXPECT_STREQ(error.what(),
                 "the instruction set of oneDNN is already fixed in this process, wanted another");
  }
  EXPECT_FALSE(has_exact_int8_products());
}

}  // namespace
}  // namespace bevloc::nn::onednn
