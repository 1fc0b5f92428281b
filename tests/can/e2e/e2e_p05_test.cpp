#include "can/e2e/e2e_p05.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "can/e2e/e2e.h"
#include "can/messages/message_table.h"
#include "tests/can/e2e/test_frames.h"

namespace bevloc::can {
namespace {

using test::flip;
using test::frame_of;

const Message& kSolution = loc_solution::kMessage;

Frame protected_solution() {
  Frame frame = blank_frame(kSolution, BaseIds{});
  for (size_t i = 3; i < frame.length; ++i) frame.data[i] ^= static_cast<uint8_t>(37 * i);
  protect_p05(frame, kSolution.data_id, 5);
  return frame;
}

/// For each bit, the change of the code word's remainder when this bit is flipped. A change of 0
/// would not be detected. CRCs are linear: several flipped bits change the remainder by the
/// exclusive or of their changes.
std::vector<uint16_t> syndromes(const Frame& intact) {
  const auto remainder = [](const Frame& frame) {
    Frame computed = frame;
    protect_p05(computed, kSolution.data_id, frame.data[2]);
    return static_cast<uint16_t>((computed.data[0] ^ frame.data[0]) |
                                 (computed.data[1] ^ frame.data[1]) << 8);
  };
  std::vector<uint16_t> of_bit;
  for (int bit = 0; bit < 8 * intact.length; ++bit) {
    Frame damaged = intact;
    flip(damaged, bit);
    of_bit.push_back(remainder(damaged));
  }
  return of_bit;
}

TEST(Crc16CcittFalse, HasThePublishedCheckValue) {
  constexpr std::string_view kText = "123456789";
  EXPECT_EQ(crc16_ccitt_false({reinterpret_cast<const uint8_t*>(kText.data()), kText.size()}),
            0x29B1);
  EXPECT_EQ(crc16_ccitt_false({}), 0xFFFF);
}

TEST(E2eP05, ReproducesPublishedVectors) {
  // The vectors of github.com/zariiii9003/autosar-e2e, test/test_p05.py.
  Frame zeros = frame_of({0, 0, 0, 0, 0, 0, 0, 0});
  protect_p05(zeros, 0x1234, 0);
  EXPECT_EQ(zeros, frame_of({0x1C, 0xCA, 0x00, 0, 0, 0, 0, 0}));
  protect_p05(zeros, 0x1234, 1);
  EXPECT_EQ(zeros, frame_of({0xCF, 0x8D, 0x01, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(has_valid_crc_p05(zeros, 0x1234));
  EXPECT_FALSE(has_valid_crc_p05(zeros, 0x1235));
  zeros.data[2] = 2;
  EXPECT_FALSE(has_valid_crc_p05(zeros, 0x1234));
}

TEST(E2eP05, EveryErrorOfOneOrTwoBitsIsRejected) {
  const Frame intact = protected_solution();
  ASSERT_TRUE(is_usable(E2eChecker(kSolution.protection(), kSolution.length).check(intact)));
  int undetected = 0;
  for (int a = 0; a < 8 * intact.length; ++a) {
    Frame one = intact;
    flip(one, a);
    undetected += has_valid_crc_p05(one, kSolution.data_id);
    for (int b = a + 1; b < 8 * intact.length; ++b) {
      Frame two = one;
      flip(two, b);
      undetected += has_valid_crc_p05(two, kSolution.data_id);
    }
  }
  EXPECT_EQ(undetected, 0);
}

TEST(E2eP05, EveryErrorOfThreeBitsIsRejected) {
  const std::vector<uint16_t> of_bit = syndromes(protected_solution());
  int undetected = 0;
  for (size_t a = 0; a < of_bit.size(); ++a) {
    for (size_t b = a + 1; b < of_bit.size(); ++b) {
      const auto two = static_cast<uint16_t>(of_bit[a] ^ of_bit[b]);
      undetected += static_cast<int>(
          std::count(of_bit.begin() + static_cast<std::ptrdiff_t>(b) + 1, of_bit.end(), two));
    }
  }
  EXPECT_EQ(undetected, 0);
}

}  // namespace
}  // namespace bevloc::can
