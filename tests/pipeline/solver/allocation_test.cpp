// No solver may allocate once it has solved: this program counts every allocation.
#include <atomic>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/solver/synthetic_scene.h"

namespace {
std::atomic<int> allocations = 0;
}  // namespace

void* operator new(size_t size) {
  ++allocations;
  void* memory = std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void* operator new(size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto unit = static_cast<size_t>(alignment);
  void* memory = std::aligned_alloc(unit, (size + unit - 1) / unit * unit);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace bevloc {
namespace {

TEST(AllocationTest, NoneAfterTheFirstSolution) {
  constexpr int kChannels = 16;
  const SyntheticScene scene = SyntheticScene::structured(kChannels, 1);
  const auto bev = scene.seen_from({0.4, 0.2, 0.01}, kFeatureGrid);
  const auto map = scene.seen_from({}, kFeatureGrid);
  const std::vector<float> nothing(bev.size(), 0.0F);
  for (const char* name : {"full", "decoupled", "decoupled-plain", "block"}) {
    auto solver =
        make_solver(*solver_kind_from(name), kFeatureGrid, kChannels, HypothesisGrid{}, {}).value();
    SolverResult result;
    solver->solve(view(bev, kChannels, kFeatureGrid), view(map, kChannels, kFeatureGrid), result);
    const int before = allocations;
    EXPECT_GT(before, 0);
    solver->solve(view(map, kChannels, kFeatureGrid), view(bev, kChannels, kFeatureGrid), result);
    solver->solve(view(nothing, kChannels, kFeatureGrid), view(bev, kChannels, kFeatureGrid),
                  result);
    EXPECT_EQ(allocations, before) << name;
  }
}

}  // namespace
}  // namespace bevloc
