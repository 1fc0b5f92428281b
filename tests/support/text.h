// Texts of tests: whole files, and texts of which a part is replaced.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "common/files.h"

namespace bevloc::test {

/// The bytes of a file. The test fails if it cannot be read.
inline std::string read_text(const std::filesystem::path& file) {
  const auto text = read_file(file);
  EXPECT_TRUE(text) << text.error().message;
  return text.value_or("");
}

/// The text with the first `from` replaced by `to`. The test fails if the text lacks `from`.
inline std::string replaced(std::string_view text, std::string_view from, std::string_view to) {
  std::string result(text);
  const size_t at = result.find(from);
  EXPECT_NE(at, std::string::npos) << "not in the text: " << from;
  return at == std::string::npos ? result : result.replace(at, from.size(), to);
}

}  // namespace bevloc::test
