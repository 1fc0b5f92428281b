// A parallel loop on OpenMP threads.
#pragma once

#include <omp.h>

namespace bevloc::nn::onednn {

/// Calls body(i) for each i in [0, count), in any order. With one thread, the calls happen in the
/// caller's thread without OpenMP, which would allocate a team of threads for each loop.
template <typename Body>
void parallel_for(int count, const Body& body) {
  if (omp_get_max_threads() == 1) {
    for (int i = 0; i < count; ++i) body(i);
    return;
  }
#pragma omp parallel for schedule(static)
  for (int i = 0; i < count; ++i) body(i);
}

}  // namespace bevloc::nn::onednn
