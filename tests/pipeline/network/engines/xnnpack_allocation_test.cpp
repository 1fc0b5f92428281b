// Checks that XNNPACK allocates only at load. XNNPACK accepts an allocator only once per process,
// so this is a separate test program.
#include <cstdlib>

#include <gtest/gtest.h>
#include <xnnpack.h>

#include "pipeline/network/engines/xnnpack/xnnpack_engine.h"
#include "pipeline/network/network.h"
#include "tests/pipeline/network/model_inputs.h"

namespace bevloc {
namespace {

/// Calls of the allocator's functions.
int calls = 0;

constexpr xnn_allocator kCountingAllocator{
    .context = nullptr,
    .allocate = [](void*, size_t bytes) { return ++calls, std::malloc(bytes); },
    .reallocate = [](void*, void* old, size_t bytes) { return ++calls, std::realloc(old, bytes); },
    .deallocate = [](void*, void* memory) { ++calls, std::free(memory); },
    .aligned_allocate =
        [](void*, size_t alignment, size_t bytes) {
          return ++calls, std::aligned_alloc(alignment, (bytes / alignment + 1) * alignment);
        },
    .aligned_deallocate = [](void*, void* memory) { ++calls, std::free(memory); },
};

TEST(XnnpackEngine, AllocatesAtLoadOnly) {
  ASSERT_EQ(xnn_initialize(&kCountingAllocator), xnn_status_success);
  for (const int threads : {1, 2}) {
    const int before_load = calls;
    auto network = Network::load(test::fixture("tiny_network_int8.onnx"),
                                 {.threads = threads, .engine = nn::make_xnnpack_engine});
    ASSERT_TRUE(network) << network.error().message;
    EXPECT_GT(calls, before_load);
    const int before_runs = calls;
    for (int run = 0; run < 2; ++run) {
      (*network)->run_image_branch();
      (*network)->run_map_branch();
      (*network)->run_mask_head();
    }
    EXPECT_EQ(calls, before_runs);
  }
}

}  // namespace
}  // namespace bevloc
