// How the loader's parts say that a model cannot be used. Loading is deep and runs once, so inside
// pipeline/network it unwinds by exception; Network::load() turns it into an Error.
#pragma once

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace bevloc::nn {

class LoadError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <typename... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) {
  throw LoadError(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace bevloc::nn
