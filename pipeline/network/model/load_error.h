// The exception by which the loader reports that a model cannot be used.
//
// Loading has many nested calls and runs once per model. Inside pipeline/network it therefore
// reports errors by exception; Network::load() and network_cost() convert it to an Error with
// loaded().
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "common/result.h"

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

/// Returns the Result of make(), or its exception as an Error. `path` is the model, for messages.
template <typename Make>
auto loaded(const std::string& path, const Make& make) -> decltype(make()) {
  try {
    return make();
  } catch (const LoadError& error) {
    return fail("{}: {}", path, error.what());
  } catch (const std::exception& error) {
    return fail("{}: cannot be loaded: {}", path, error.what());
  }
}

}  // namespace bevloc::nn
