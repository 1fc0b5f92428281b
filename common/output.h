// Turns exceptions of a program into errors, and makes sure that its output arrives and is
// printable.
#pragma once

#include <cerrno>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "common/result.h"

namespace bevloc {

/// Runs `run`, which returns a Result. The C++ library throws when a disk is full, a pipe is closed
/// or a folder is missing. This function returns an error instead.
template <typename Run>
auto run_without_throwing(const Run& run) -> decltype(run()) {
  try {
    return run();
  } catch (const std::system_error& error) {
    return fail("found an error of the system ({})", error.what());
  }
}

/// Returns the text of a message, with hexadecimal numbers in place of control characters other
/// than newlines. Such characters may come from a damaged file, and a terminal would obey them.
inline std::string printable(std::string_view text) {
  std::string shown;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte < 0x20 && c != '\n') || byte == 0x7F) {
      fmt::format_to(std::back_inserter(shown), "\\x{:02X}", byte);
    } else {
      shown += c;
    }
  }
  return shown;
}

/// Fails if something that was printed on standard output did not arrive.
inline Status flush_output() {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good()) return {};
  return fail("standard output: found {}, wanted room for all that is printed",
              std::generic_category().message(errno));
}

}  // namespace bevloc
