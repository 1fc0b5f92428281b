// Lets libFuzzer run one target: BEVLOC_FUZZ_TARGET is its name.
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  for (const bevloc::fuzz::Target& target : bevloc::fuzz::kTargets) {
    if (target.name == BEVLOC_FUZZ_TARGET) target.run({data, size});
  }
  return 0;
}
