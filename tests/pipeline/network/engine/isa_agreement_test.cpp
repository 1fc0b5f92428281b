// Runs the shipped model under each cap on the instruction set and with several threads. A cap
// applies to a whole process, so each run happens in a child process.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <dnnl.hpp>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pipeline/map/rasterizer.h"
#include "pipeline/network/kernels/strip_kernels.h"
#include "pipeline/network/network.h"
#include "tests/pipeline/network/golden_samples.h"

namespace bevloc {
namespace {

struct Outputs {
  int onednn_isa = 0;  ///< the dnnl::cpu_isa that oneDNN used
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

bool write_all(int pipe, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(pipe, bytes.data(), bytes.size());
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
  return true;
}

bool read_all(int pipe, std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t got = read(pipe, bytes.data(), bytes.size());
    if (got <= 0) return false;
    bytes = bytes.subspan(static_cast<size_t>(got));
  }
  return true;
}

/// Runs in the child: writes oneDNN's instruction set and all outputs to the pipe and exits.
[[noreturn]] void answer(int pipe, IsaCap cap, int threads) {
  const auto network =
      Network::load(BEVLOC_SOURCE_DIR "/models/nano.onnx", {.threads = threads, .isa = cap});
  if (!network) _exit(1);
  run(**network);
  const int isa = static_cast<int>(dnnl::get_effective_cpu_isa());
  const bool written = write_all(pipe, std::as_bytes(std::span(&isa, 1))) &&
                       write_all(pipe, std::as_bytes((*network)->bev_features().data)) &&
                       write_all(pipe, std::as_bytes((*network)->map_features().data)) &&
                       write_all(pipe, std::as_bytes((*network)->mask_logits()));
  _exit(written ? 0 : 1);
}

/// The outputs under a cap, computed in a child process.
Outputs outputs_of(IsaCap cap, int threads) {
  constexpr size_t kFeatures = static_cast<size_t>(kFeatureChannels) * kFeatureGrid.cells();
  Outputs outputs{0, std::vector<float>(kFeatures), std::vector<float>(kFeatures),
                  std::vector<float>(kRasterSize)};
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) answer(ends[1], cap, threads);
  close(ends[1]);
  EXPECT_TRUE(read_all(ends[0], std::as_writable_bytes(std::span(&outputs.onednn_isa, 1))) &&
              read_all(ends[0], std::as_writable_bytes(std::span(outputs.bev))) &&
              read_all(ends[0], std::as_writable_bytes(std::span(outputs.map))) &&
              read_all(ends[0], std::as_writable_bytes(std::span(outputs.mask))));
  close(ends[0]);
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  return outputs;
}

/// The outputs without a cap.
const Outputs& best() {
  static const Outputs outputs = outputs_of(IsaCap::kBest, 1);
  return outputs;
}

/// Largest difference, in steps of the output: its largest value is 127 steps. Infinite if a value
/// is not finite.
double steps_between(const std::vector<float>& a, const std::vector<float>& b) {
  float largest = 0.0F;
  float difference = 0.0F;
  for (size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(a[i] - b[i])) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, std::abs(a[i]));
    difference = std::max(difference, std::abs(a[i] - b[i]));
  }
  return 127.0 * difference / largest;
}

TEST(StepsBetween, CountsWhatIsNotFiniteAsFarApart) {
  const float not_a_number = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(steps_between({127.0F, 1.0F}, {127.0F, 3.0F}), 2.0);
  EXPECT_GT(steps_between({127.0F, 1.0F}, {127.0F, not_a_number}), 1e9);
  EXPECT_GT(steps_between({127.0F, not_a_number}, {127.0F, 1.0F}), 1e9);
  EXPECT_GT(steps_between({not_a_number, not_a_number}, {not_a_number, not_a_number}), 1e9);
}

/// Compares the outputs with several threads with those of one thread.
void expect_threads_change_nothing(IsaCap cap, const Outputs& one) {
  for (const int threads : {2, 3, 8}) {
    const Outputs found = outputs_of(cap, threads);
    EXPECT_EQ(found.bev, one.bev) << threads;
    EXPECT_EQ(found.map, one.map) << threads;
    EXPECT_EQ(found.mask, one.mask) << threads;
  }
}

struct NamedCap {
  std::string name;
  IsaCap cap;
};

/// Skips the caps with which this CPU runs the same kernels as without a cap.
class IsaAgreement : public testing::TestWithParam<NamedCap> {
 protected:
  void SetUp() override {
    const auto& [name, cap] = GetParam();
    one_thread_ = outputs_of(cap, 1);
    const bool is_same = &nn::kernel_set(cap) == &nn::kernel_set(IsaCap::kBest) &&
                         one_thread_.onednn_isa == best().onednn_isa;
    if (is_same) GTEST_SKIP() << name << ": this CPU runs the same kernels without a cap";
  }

  Outputs one_thread_;
};

TEST_P(IsaAgreement, OutputsAreTheBestInstructionsWithinAStep) {
  EXPECT_LE(steps_between(best().bev, one_thread_.bev), 1.0);
  EXPECT_LE(steps_between(best().map, one_thread_.map), 1.0);
  EXPECT_LE(steps_between(best().mask, one_thread_.mask), 1.0);
}

TEST_P(IsaAgreement, ThreadsDoNotChangeTheOutputs) {
  expect_threads_change_nothing(GetParam().cap, one_thread_);
}

INSTANTIATE_TEST_SUITE_P(Caps, IsaAgreement,
                         testing::Values(NamedCap{"avx512vnni", IsaCap::kAvx512Vnni},
                                         NamedCap{"avx512", IsaCap::kAvx512},
                                         NamedCap{"avx2vnni", IsaCap::kAvx2Vnni},
                                         NamedCap{"avx2", IsaCap::kAvx2}),
                         [](const auto& named) { return named.param.name; });

TEST(BestInstructions, ThreadsDoNotChangeTheOutputs) {
  expect_threads_change_nothing(IsaCap::kBest, best());
}

}  // namespace
}  // namespace bevloc
