// Checks of command line options. Their messages say what was found and what was wanted.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/number_text.h"
#include "common/output_file.h"

namespace bevloc {

/// The exit code of a program that was used wrongly, or that cannot work with its input or machine.
inline constexpr int kBadInput = 2;

/// Accepts a number from `low` to `high`, but not nan or inf.
inline CLI::Validator number_between(double low, double high) {
  const auto check = [low, high](const std::string& text) -> std::string {
    const auto number = parse_number<double>(text);
    if (number >= low && number <= high) return "";
    return fmt::format("found '{}', wanted a number from {} to {}", text, low, high);
  };
  return {check, fmt::format("{} to {}", low, high), ""};
}

/// Accepts a seed: a whole number from 0 to `highest`, also in hexadecimal (0x1F).
inline CLI::Validator whole_number(uint64_t highest = std::numeric_limits<uint64_t>::max()) {
  const auto check = [highest](const std::string& text) -> std::string {
    const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
    const std::string_view digits = std::string_view(text).substr(hexadecimal ? 2 : 0);
    const auto number = parse_number<uint64_t>(digits, hexadecimal ? 16 : 10);
    if (number && *number <= highest) return "";
    return fmt::format("found '{}', wanted a whole number from 0 to {}", text, highest);
  };
  return {check, "", ""};
}

/// Refuses an empty name, which an unset variable of a script gives. `wanted` says what has the
/// name, such as "a folder".
inline CLI::Validator is_name_of(const std::string& wanted) {
  const auto check = [wanted](const std::string& text) -> std::string {
    return text.empty() ? fmt::format("found an empty name, wanted {}", wanted) : "";
  };
  return {check, "", ""};
}

/// Requires the name of a file to write. Refuses "-", which means standard output, because the file
/// would mix with what the command prints. The file may lie in a folder that the command creates.
/// Then the command calls check_writable() itself.
inline CLI::Validator output_name() {
  const auto check = [](const std::string& text) -> std::string {
    if (text.empty()) return "found an empty name, wanted a file to write";
    return text == "-" ? "found '-', wanted the name of a file, not standard output" : "";
  };
  return {check, "", ""};
}

/// Requires the name of a file that can be written, so that a long run does not end without its
/// result.
inline CLI::Validator output_file() {
  const auto check = [](const std::string& text) -> std::string {
    if (std::string refused = output_name()(text); !refused.empty()) return refused;
    const Status writable = check_writable(text);
    return writable ? "" : writable.error().message;
  };
  return {check, "", ""};
}

/// Like output_file(), for a file that replace_file() writes.
inline CLI::Validator replaced_file() {
  const auto check = [](const std::string& text) -> std::string {
    if (std::string refused = output_name()(text); !refused.empty()) return refused;
    const Status replaceable = check_replaceable(text);
    return replaceable ? "" : replaceable.error().message;
  };
  return {check, "", ""};
}

/// Parses the command line of a tool. If the program has to end, returns its exit code: 0 after
/// --help, 2 after wrong options. Otherwise returns nothing.
inline std::optional<int> parse_options(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadInput;
  }
  return std::nullopt;
}

}  // namespace bevloc
