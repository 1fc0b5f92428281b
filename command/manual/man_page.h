// Writes manual pages (roff) from the option table of a program and from a schema.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "command/manual/option_table.h"

namespace bevloc::command {

/// The texts of a page that the table of a program lacks.
struct ManHeader {
  std::string name;  ///< "bevloc"
  int section = 1;
  std::string what;                     ///< what the program is, in half a line
  std::vector<std::string> see_also{};  ///< "bevlocd(8)"
  std::string exit_codes{};             ///< one line for each, "0  good"; empty: none
};

/// Returns a page with synopsis, every command with its options and examples, and exit codes.
std::string man_page_of_program(const ManHeader& header, const CommandEntry& table);

/// Returns a page with every key, its values, default and meaning.
std::string man_page_of_schema(const ManHeader& header, const nlohmann::ordered_json& schema);

}  // namespace bevloc::command
