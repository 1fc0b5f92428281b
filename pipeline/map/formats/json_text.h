// JSON text with line numbers for messages.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/result.h"

namespace bevloc {

/// A parsed JSON file. The text must outlive it. Immutable, and so thread-safe.
class JsonText {
 public:
  /// Fails on text that is not JSON, with file, line and byte. Fails on text that is nested more
  /// deeply than any map, or has a number beyond the range of double, with the file only.
  static Result<JsonText> parse(std::string_view text, const std::string& file);

  const nlohmann::json& root() const { return root_; }
  const std::string& file() const { return file_; }

  /// "file:line: /path" of a value, for the start of a message. It searches the text, so use it for
  /// errors only.
  std::string place(const nlohmann::json::json_pointer& path) const;

 private:
  JsonText(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  std::string_view text_;
  std::string file_;
  nlohmann::json root_;
};

}  // namespace bevloc
