// Runs the shipped model under each cap on the instruction set and with several threads. A cap
// applies to a whole process, so each run happens in a child process.
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pipeline/map/rasterizer.h"
#include "pipeline/network/network.h"
#include "tests/pipeline/network/golden_samples.h"

namespace bevloc {
namespace {

struct Outputs {
  std::vector<float> bev;
  std::vector<float> map;
  std::vector<float> mask;
};

/// Runs all branches on the first golden sample.
void run(Network& network) {
  test::set_golden_input(network, 0);
  network.run_image_branch();
  network.run_map_branch();
  network.run_mask_head();
}

bool write_all(int pipe, std::span<const float> values) {
  auto bytes = std::as_bytes(values);
  while (!bytes.empty()) {
    const ssize_t written = write(pipe, bytes.data(), bytes.size());
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
  return true;
}

bool read_all(int pipe, std::span<float> values) {
  auto bytes = std::as_writable_bytes(values);
  while (!bytes.empty()) {
    const ssize_t got = read(pipe, bytes.data(), bytes.size());
    if (got <= 0) return false;
    bytes = bytes.subspan(static_cast<size_t>(got));
  }
  return true;
}

/// Runs in the child: writes all outputs to the pipe and exits.
[[noreturn]] void answer(int pipe, IsaCap cap, int threads) {
  const auto network =
      Network::load(BEVLOC_SOURCE_DIR "/models/nano.onnx", {.threads = threads, .isa = cap});
  if (!network) _exit(1);
  run(**network);
  const bool written = write_all(pipe, (*network)->bev_features().data) &&
                       write_all(pipe, (*network)->map_features().data) &&
                       write_all(pipe, (*network)->mask_logits());
  _exit(written ? 0 : 1);
}

/// The outputs under a cap, computed in a child process.
Outputs outputs_of(IsaCap cap, int threads) {
  constexpr size_t kFeatures = static_cast<size_t>(kFeatureChannels) * kFeatureGrid.cells();
  Outputs outputs{std::vector<float>(kFeatures), std::vector<float>(kFeatures),
                  std::vector<float>(kRasterSize)};
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) answer(ends[1], cap, threads);
  close(ends[1]);
  EXPECT_TRUE(read_all(ends[0], outputs.bev) && read_all(ends[0], outputs.map) &&
              read_all(ends[0], outputs.mask));
  close(ends[0]);
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  return outputs;
}

/// Largest difference, in steps of the output: its largest value is 127 steps.
double steps_between(const std::vector<float>& a, const std::vector<float>& b) {
  float largest = 0.0F;
  float difference = 0.0F;
  for (size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(a[i]));
    difference = std::max(difference, std::abs(a[i] - b[i]));
  }
  return 127.0 * difference / largest;
}

struct NamedCap {
  std::string name;
  IsaCap cap;
};

class IsaAgreement : public testing::TestWithParam<NamedCap> {};

TEST_P(IsaAgreement, OutputsAreTheBestInstructionsWithinAStep) {
  static const Outputs best = outputs_of(IsaCap::kBest, 1);
  const Outputs found = outputs_of(GetParam().cap, 1);
  EXPECT_LE(steps_between(best.bev, found.bev), 1.0);
  EXPECT_LE(steps_between(best.map, found.map), 1.0);
  EXPECT_LE(steps_between(best.mask, found.mask), 1.0);
}

TEST_P(IsaAgreement, ThreadsDoNotChangeTheOutputs) {
  const Outputs one = outputs_of(GetParam().cap, 1);
  for (const int threads : {2, 3, 8}) {
    const Outputs found = outputs_of(GetParam().cap, threads);
    EXPECT_EQ(found.bev, one.bev) << threads;
    EXPECT_EQ(found.map, one.map) << threads;
    EXPECT_EQ(found.mask, one.mask) << threads;
  }
}

INSTANTIATE_TEST_SUITE_P(Caps, IsaAgreement,
                         testing::Values(NamedCap{"best", IsaCap::kBest},
                                         NamedCap{"avx512vnni", IsaCap::kAvx512Vnni},
                                         NamedCap{"avx512", IsaCap::kAvx512},
                                         NamedCap{"avx2vnni", IsaCap::kAvx2Vnni},
                                         NamedCap{"avx2", IsaCap::kAvx2}),
                         [](const auto& named) { return named.param.name; });

}  // namespace
}  // namespace bevloc
