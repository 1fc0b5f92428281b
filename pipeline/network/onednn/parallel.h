// Loops on OpenMP's threads.
#pragma once

#include <omp.h>

namespace bevloc::nn::onednn {

/// turn(i) for i from 0 up to `count`, in any order. With one thread it stays in the caller's:
/// OpenMP would allocate a team for each loop.
template <typename Turn>
void for_each_turn(int count, const Turn& turn) {
  if (omp_get_max_threads() == 1) {
    for (int i = 0; i < count; ++i) turn(i);
    return;
  }
#pragma omp parallel for schedule(static)
  for (int i = 0; i < count; ++i) turn(i);
}

}  // namespace bevloc::nn::onednn
