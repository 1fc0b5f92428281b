// The measured peak of the network's own kernels. The test does not check times.
#include "evaluation/bench/strip_peak.h"

#include <gtest/gtest.h>

namespace bevloc::bench {
namespace {

TEST(StripPeak, CountsTheProductsOfAllThreads) {
  const auto run_in = [](double seconds) {
    return [seconds](const std::function<void()>& run) {
      run();
      return seconds;
    };
  };
  const double one = strip_macs_per_s(1, run_in(1.0));
  EXPECT_GT(one, 0.0);
  EXPECT_DOUBLE_EQ(strip_macs_per_s(2, run_in(1.0)), 2.0 * one);
  EXPECT_DOUBLE_EQ(strip_macs_per_s(1, run_in(0.5)), 2.0 * one);
}

}  // namespace
}  // namespace bevloc::bench
