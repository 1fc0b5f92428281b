// The exception by which the loader reports that a model cannot be used.
//
// Loading has many nested calls and runs once per model. Inside pipeline/network it therefore
// reports errors by exception; Network::load() and network_cost() convert it to an Error.
#pragma once

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace bevloc::nn {

class LoadError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws a LoadError with the formatted message.
template <typename... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) {
  throw LoadError(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace bevloc::nn
