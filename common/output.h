// What a program printed, and whether it arrived.
#pragma once

#include <cerrno>
#include <cstdio>
#include <iostream>
#include <system_error>

#include "common/result.h"

namespace bevloc {

/// Runs `run`, which returns a Result. The C++ library throws where a disk is full, a pipe is
/// closed or a folder is missing; here that becomes an error.
template <typename Run>
auto run_without_throwing(const Run& run) -> decltype(run()) {
  try {
    return run();
  } catch (const std::system_error& error) {
    return fail("found an error of the system ({})", error.what());
  }
}

/// Fails if something that was printed on standard output did not arrive.
inline Status flush_output() {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good()) return {};
  return fail("standard output: found {}, wanted room for all that is printed",
              std::generic_category().message(errno));
}

}  // namespace bevloc
