// Result and Status: how a function reports that something outside the program is wrong.
#pragma once

#include <string>
#include <utility>

#include <fmt/format.h>
#include <tl/expected.hpp>

namespace bevloc {

/// One sentence for the person who has to fix the problem: "place: found X, wanted Y". For a file,
/// place is "file:line: key" as far as it is known.
struct Error {
  std::string message;
};

/// A value, or the reason why there is none. Programming errors are asserted, not returned.
template <typename T>
using Result = tl::expected<T, Error>;

/// Success, or the reason for the failure.
using Status = Result<void>;

/// Makes an error: `return fail("{}:{}: found a focal length of {}, wanted more than 0", ...);`
template <typename... Args>
tl::unexpected<Error> fail(fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected(Error{fmt::format(format, std::forward<Args>(args)...)});
}

}  // namespace bevloc
