#include "pipeline/network/kernels/requantize.h"

#include <array>
#include <span>
#include <vector>

#include <gtest/gtest.h>

namespace bevloc::nn {
namespace {

TEST(Requantize, RoundsHalfToEvenAndCutsOff) {
  constexpr auto kUnsigned = ElementType::kUint8;
  constexpr auto kSigned = ElementType::kInt8;
  Requantizer requantizer;
  requantizer.channels = 11;
  requantizer.scale.assign(11, 0.5F);
  std::vector<int32_t> sums{1, 3, 5, -1, -3, 510, 511, 9000, -9000, 2'000'000'000, 4};
  sums.resize(16);  // kernels read whole vectors
  const auto rounded = [&](ElementType type, Requantize requantize) {
    requantizer.output = type;
    std::vector<int> results;
    std::array<uint8_t, 11> output{};
    requantize(requantizer, {.sums = sums.data(),
                             .sums_step = 16,
                             .pixels = 1,
                             .output = std::as_writable_bytes(std::span(output)).data()});
    for (const uint8_t byte : output) {
      results.push_back(type == kUnsigned ? byte : static_cast<int8_t>(byte));
    }
    return results;
  };
  const auto best = [](ElementType type) {
    Requantizer any;
    any.output = type;
    return requantize_for(any, false);
  };
  const std::vector<int> unsigned_wanted{0, 2, 2, 0, 0, 255, 255, 255, 0, 255, 2};
  const std::vector<int> signed_wanted{0, 2, 2, 0, -2, 127, 127, 127, -128, 127, 2};
  EXPECT_EQ(rounded(kUnsigned, requantize_plain(kUnsigned, kUnsigned, false)), unsigned_wanted);
  EXPECT_EQ(rounded(kSigned, requantize_plain(kSigned, kUnsigned, false)), signed_wanted);
  EXPECT_EQ(rounded(kUnsigned, best(kUnsigned)), unsigned_wanted);
  EXPECT_EQ(rounded(kSigned, best(kSigned)), signed_wanted);
}

}  // namespace
}  // namespace bevloc::nn
