// The network's answer to a test frame, by which a wrong computation is detected at run time.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "common/result.h"
#include "pipeline/network/network.h"

namespace bevloc {

/// The features of one side in a few numbers: sums over all values, each value with a pseudo-random
/// sign. For the difference of two sets of features, the mean square of these sums is about the sum
/// of the squared differences. So the sums show the relative difference of the features.
struct FeatureAnswer {
  static constexpr int kSums = 8;

  double norm = 0.0;  ///< the square root of the sum of squares
  std::array<double, kSums> sums{};
};

struct NetworkAnswer {
  FeatureAnswer bev;
  FeatureAnswer map;
};

/// Key of the model's metadata that holds to_text() of its answer (`bevloc store-answer`).
inline constexpr std::string_view kAnswerKey = "bevloc.test_frame_answer";

/// Runs the image branch and the map branch on the test frame: images, raster and view table that
/// follow from formulas. Overwrites the network's inputs and its view table. Does not allocate
/// after the first call.
NetworkAnswer answer_to_test_frame(Network& network);

/// Fails if the features of one side differ by more than 3 % in the root mean square. The answers
/// of two instruction sets differ by less than 1 % (tests/pipeline/network/network_test.cpp),
/// because a sum at a rounding boundary may round differently.
Status check_answer(const NetworkAnswer& found, const NetworkAnswer& wanted);

/// The numbers of an answer, separated by blanks.
std::string to_text(const NetworkAnswer& answer);
/// Fails unless the text has exactly those numbers, all finite, with norms above 0.
Result<NetworkAnswer> answer_from(std::string_view text);

}  // namespace bevloc
