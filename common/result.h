// How a function says that something outside the program is wrong.
#pragma once

#include <string>
#include <utility>

#include <fmt/format.h>
#include <tl/expected.hpp>

namespace bevloc {

/// One clear sentence for the person who has to put it right. For a file: "place: what was found,
/// what was wanted", where place is "file:line: key" as far as it is known.
struct Error {
  std::string message;
};

/// A value, or the reason why there is none. Asserts, not results, are for our own bugs.
template <typename T>
using Result = tl::expected<T, Error>;

/// A step that either worked or says why not.
using Status = Result<void>;

/// `return fail("{}:{}: focal length is {}, wanted more than 0", file, line, fx);`
template <typename... Args>
tl::unexpected<Error> fail(fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected(Error{fmt::format(format, std::forward<Args>(args)...)});
}

}  // namespace bevloc
