// Writes JSON that may contain text from outside.
#pragma once

#include <string>

namespace bevloc {

/// A value of nlohmann's JSON as text. Bytes that are not UTF-8, such as names from a file in
/// Latin-1, become U+FFFD. The library's own dump() would throw.
template <typename Json>
std::string dump_json(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

/// The content of a JSON file: indented, with a newline at its end.
template <typename Json>
std::string json_document(const Json& json) {
  return dump_json(json, 2) + "\n";
}

}  // namespace bevloc
