// Prepares the text of a number for std::from_chars.
#pragma once

#include <string_view>

namespace bevloc {

/// Returns the text without white space around it, and without the "+" that std::from_chars does
/// not know.
inline std::string_view trimmed_number(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  text = text.substr(first, text.find_last_not_of(kSpace) - first + 1);
  if (text.starts_with('+') && text.size() > 1 && text[1] != '-') text.remove_prefix(1);
  return text;
}

}  // namespace bevloc
