// Bytes as text.
#pragma once

#include <string>
#include <string_view>

namespace bevloc {

/// Returns the bytes in base64 (RFC 4648, chapter 4), with padding and without line breaks.
std::string base64(std::string_view bytes);

}  // namespace bevloc
