// The answer to the test frame: of the shipped model, of damaged weights, and as text.
// engine/under_test/ has a file for each form of the engine that these test cases run on.
#include "pipeline/network/test_frame.h"

#include <cmath>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/pipeline/network/model_inputs.h"
#include "tests/pipeline/network/network_under_test.h"
#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

TEST(TestFrame, TheShippedModelGivesItsStoredAnswer) {
  const auto network = test::load_shipped();
  ASSERT_TRUE(network);
  const auto stored = answer_from(network->stored_answer());
  ASSERT_TRUE(stored) << stored.error().message;
  const NetworkAnswer found = answer_to_test_frame(*network);
  const Status same = check_answer(found, *stored);
  EXPECT_TRUE(same) << same.error().message;
  EXPECT_EQ(to_text(answer_to_test_frame(*network)), to_text(found));
}

TEST(TestFrame, AModelWithDamagedWeightsIsFound) {
  const auto whole = test::load_shipped();
  ASSERT_TRUE(whole);
  const NetworkAnswer wanted = answer_to_test_frame(*whole);
  const std::string bytes = test::read_bytes(test::kShippedModel);
  const test::TemporaryFolder folder;
  const std::string path = folder / "damaged.onnx";
  int judged = 0;
  for (const size_t place : {bytes.size() / 5, bytes.size() / 2, bytes.size() * 4 / 5}) {
    std::string damaged = bytes;
    // One page of bits that do not hold their value.
    for (size_t i = 0; i < 4096; ++i)
      damaged[place + i] = static_cast<char>(damaged[place + i] ^ 0x20);
    std::ofstream(path, std::ios::binary) << damaged;
    const auto network = Network::load(path, test::network_options());
    if (!network) continue;  // the page held more than weights
    ++judged;
    const Status same = check_answer(answer_to_test_frame(**network), wanted);
    ASSERT_FALSE(same) << place;
    EXPECT_THAT(same.error().message, ::testing::HasSubstr("replace the model file"));
  }
  EXPECT_GT(judged, 0);
}

TEST(TestFrame, AnAnswerSurvivesItsText) {
  const auto network = test::load_shipped();
  ASSERT_TRUE(network);
  const NetworkAnswer answer = answer_to_test_frame(*network);
  const auto read = answer_from(to_text(answer));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(check_answer(*read, answer));
  NetworkAnswer other = answer;
  other.map.sums[3] += 0.2 * answer.map.norm;
  EXPECT_FALSE(check_answer(other, answer));
  other.map.sums[3] = std::nan("");
  EXPECT_FALSE(check_answer(other, answer));
}

TEST(TestFrame, ADamagedTextIsRefused) {
  const std::string good = "1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 9";
  EXPECT_TRUE(answer_from(good));
  const std::string rest = good.substr(1);
  for (const std::string& text :
       {std::string(), good + " 1", rest, std::string("0").append(rest),
        std::string("x").append(rest), std::string("nan").append(rest), good + " ",
        std::string(" ").append(good), std::string("1  2 3")}) {
    const auto answer = answer_from(text);
    ASSERT_FALSE(answer) << text;
    EXPECT_THAT(answer.error().message, ::testing::HasSubstr("bevloc store-answer"));
  }
}

}  // namespace
}  // namespace bevloc
