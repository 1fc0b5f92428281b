#include "can/secoc/cmac.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "evaluation/bench/allocation_count.h"

namespace bevloc::can {
namespace {

std::vector<uint8_t> bytes_of(const std::string& hex) {
  std::vector<uint8_t> bytes;
  for (size_t i = 0; i < hex.size(); i += 2) {
    bytes.push_back(static_cast<uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

SecocKey key_of(const std::string& hex) {
  SecocKey key{};
  std::ranges::copy(bytes_of(hex), key.begin());
  return key;
}

/// RFC 4493, section 4.
TEST(Cmac, ComputesTheTestVectorsOfTheRfc) {
  const std::string message =
      "6bc1bee22e409f96e93d7e117393172aae2d8a571e03ac9c9eb76fac45af8e51"
      "30c81c46a35ce411e5fbc1191a0a52eff69f2445df4f9b17ad2b417be66c3710";
  auto cmac = Cmac::create(key_of("2b7e151628aed2a6abf7158809cf4f3c"));
  ASSERT_TRUE(cmac);
  const std::pair<size_t, std::string> vectors[] = {{0, "bb1d6929e95937287fa37d129b756746"},
                                                    {16, "070a16b46b4d4144f79bdd9dd04a287c"},
                                                    {40, "dfa66747de9ae63030ca32611497c827"},
                                                    {64, "51f0bebf7e3b9d92fc49741779363cfe"}};
  for (const auto& [length, expected] : vectors) {
    Cmac::Tag tag{};
    const auto input = bytes_of(message.substr(0, 2 * length));
    EXPECT_TRUE(cmac->compute(input, tag));
    EXPECT_EQ(std::vector<uint8_t>(tag.begin(), tag.end()), bytes_of(expected)) << length;
  }
}

TEST(Cmac, DoesNotAllocateAfterItsConstruction) {
  auto cmac = Cmac::create(SecocKey{1, 2, 3});
  ASSERT_TRUE(cmac);
  const std::array<uint8_t, 100> message{};
  Cmac::Tag tag{};
  EXPECT_TRUE(cmac->compute(message, tag));
  const uint64_t before = bench::allocation_count();
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(cmac->compute(message, tag));
  EXPECT_EQ(bench::allocation_count() - before, 0u);
}

}  // namespace
}  // namespace bevloc::can
