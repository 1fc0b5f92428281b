#include "command/manual/man_page.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/version.h"

namespace bevloc::command {
namespace {

using Json = nlohmann::ordered_json;

/// Returns the text in a form that roff shows as it is.
std::string roff(const std::string& text) {
  std::string escaped;
  bool line_begins = true;
  for (const char c : text) {
    // A dot or quote at the beginning of a line would be a request.
    if (line_begins && (c == '.' || c == '\'')) escaped += "\\&";
    line_begins = c == '\n';
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string heading(const ManHeader& header) {
  std::string title = header.name;
  std::ranges::transform(title, title.begin(), [](unsigned char c) { return toupper(c); });
  return fmt::format(".TH {} {} \"\" \"bevloc {}\" \"bevloc\"\n.SH NAME\n{} \\- {}\n", roff(title),
                     header.section, version(), roff(header.name), roff(header.what));
}

std::string closing(const ManHeader& header) {
  std::string text;
  if (!header.exit_codes.empty()) {
    text += fmt::format(".SH EXIT STATUS\n.nf\n{}\n.fi\n", roff(header.exit_codes));
  }
  if (!header.see_also.empty()) {
    text += fmt::format(".SH SEE ALSO\n{}\n",
                        roff(fmt::format("{}", fmt::join(header.see_also, ", "))));
  }
  return text;
}

std::string option_text(const OptionEntry& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.names) names.push_back("\\fB" + roff(name) + "\\fR");
  const std::string value =
      option.choices.empty() ? option.value : fmt::format("{}", fmt::join(option.choices, "|"));
  std::string text =
      fmt::format(".TP\n{}{}\n{}", fmt::join(names, ", "),
                  value.empty() ? "" : " \\fI" + roff(value) + "\\fR", roff(option.description));
  if (option.required) text += " (required)";
  if (!option.default_value.empty())
    text += fmt::format(" (default: {})", roff(option.default_value));
  return text + "\n";
}

/// Returns the text as a line, and adds a full stop unless it ends a sentence itself.
std::string sentence(const std::string& text) {
  const bool ends = !text.empty() && std::string(".?!").find(text.back()) != std::string::npos;
  return roff(text) + (ends ? "\n" : ".\n");
}

std::string command_text(const CommandEntry& command) {
  std::string text = sentence(command.description);
  for (const OptionEntry& option : command.options) text += option_text(option);
  if (!command.footer.empty()) text += fmt::format(".PP\n.nf\n{}\n.fi\n", roff(command.footer));
  return text;
}

/// Returns the values that a key may have: the words of "enum", a range of numbers, or a type.
std::string values_of(const Json& schema) {
  if (schema.contains("enum")) {
    std::vector<std::string> words;
    for (const Json& word : schema["enum"]) words.push_back(word.get<std::string>());
    return fmt::format("{}", fmt::join(words, ", "));
  }
  if (!schema.contains("type")) return "depends on other keys";
  if (schema["type"].is_array()) return "text";
  const std::string type = schema["type"];
  if (type == "boolean") return "true, false";
  if (type == "array") {
    const std::string item = values_of(schema["items"]);
    return schema.contains("minItems")
               ? fmt::format("list of {}: {}", schema["minItems"].dump(), item)
               : "list: " + item;
  }
  if (type != "number" && type != "integer") return type;
  std::string text = type == "integer" ? "whole number" : "number";
  const bool low = schema.contains("minimum");
  const bool high = schema.contains("maximum");
  if (low && high) {
    text += fmt::format(", {} to {}", schema["minimum"].dump(), schema["maximum"].dump());
  } else if (low) {
    text += fmt::format(", at least {}", schema["minimum"].dump());
  } else if (schema.contains("exclusiveMinimum")) {
    text += fmt::format(", more than {}", schema["exclusiveMinimum"].dump());
  }
  return text;
}

bool requires_key(const Json& schema, const std::string& name) {
  const Json keys = schema.value("required", Json::array());
  return std::ranges::find(keys, Json(name)) != keys.end();
}

/// Returns " Required with driver: mock." for a condition on one key of the same mapping. Returns
/// nothing for other conditions.
std::string condition_text(const Json& condition) {
  const Json properties = condition.value("properties", Json::object());
  if (properties.size() != 1) return "";
  const Json& words = properties.front();
  if (!words.contains("const") && !words.contains("enum")) return "";
  const std::string values =
      words.contains("const") ? words["const"].get<std::string>() : values_of(words);
  return fmt::format(" Required with {}: {}.", properties.begin().key(), values);
}

/// Says whether a mapping requires a key, always or with some words of another key.
std::string required_text(const Json& mapping, const std::string& name) {
  if (requires_key(mapping, name)) return " Required.";
  for (const Json& rule : mapping.value("allOf", Json::array())) {
    if (rule.contains("then") && requires_key(rule["then"], name)) {
      return condition_text(rule["if"]);
    }
  }
  return "";
}

/// Returns all keys of a mapping, and those of mappings inside it.
std::string keys_text(const Json& mapping, const std::string& prefix) {
  std::string text;
  for (const auto& [name, schema] : mapping.at("properties").items()) {
    const std::string path = prefix.empty() ? name : prefix + "." + name;
    const bool is_list =
        schema.value("type", Json()) == "array" && schema.at("items").contains("properties");
    const Json& inner = is_list ? schema.at("items") : schema;
    const bool is_map = inner.contains("properties");
    if (prefix.empty()) text += fmt::format(".SH {}\n", roff(name));
    if (!prefix.empty() || !is_map) {
      text += fmt::format(".TP\n\\fB{}\\fR\n", roff(path));
      text += fmt::format(
          "{}.", roff(is_map ? (is_list ? "list of mappings" : "mapping") : values_of(schema)));
      text += roff(required_text(mapping, name));
      if (schema.contains("default"))
        text += fmt::format(" Default: {}.", roff(schema["default"].dump()));
      text += "\n";
    }
    const std::string description = schema.value("description", "");
    if (prefix.empty() && is_map && requires_key(mapping, name)) text += "Required.\n";
    if (!description.empty()) text += roff(description) + "\n";
    if (is_map) text += keys_text(inner, path + (is_list ? "[]" : ""));
  }
  return text;
}

}  // namespace

std::string man_page_of_program(const ManHeader& header, const CommandEntry& table) {
  std::string text = heading(header) + ".SH SYNOPSIS\n";
  for (const CommandEntry* command : all_commands(table)) {
    if (!command->commands.empty()) continue;
    text += fmt::format(".B {} {}\n.RI [ options ]\n.br\n", roff(header.name), roff(command->path));
  }
  text += ".SH DESCRIPTION\n" + command_text(table);
  if (!table.commands.empty()) text += ".SH COMMANDS\n";
  for (const CommandEntry* command : all_commands(table)) {
    if (command == &table) continue;
    text += fmt::format(".SS {} {}\n{}", roff(header.name), roff(command->path),
                        command_text(*command));
  }
  return text + closing(header);
}

std::string man_page_of_schema(const ManHeader& header, const Json& schema) {
  return heading(header) + ".SH DESCRIPTION\n" +
         "A YAML file. Every key must be known, present once, of the right type and in range.\n" +
         keys_text(schema, "") + closing(header);
}

}  // namespace bevloc::command
