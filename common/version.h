// The version of bevloc.
#pragma once

#include <string_view>

namespace bevloc {

/// The version in CMakeLists.txt, such as "0.1.0". The option --version, the first log line and the
/// DBC file show it.
std::string_view version();

}  // namespace bevloc
