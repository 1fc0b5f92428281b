// Command line options whose value is one of several names.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

namespace bevloc::evaluation {

template <typename Value>
using Choices = std::vector<std::pair<std::string, Value>>;

/// Adds an option that sets `value` to the value of the chosen name. The help and the error message
/// list the names; the name of the present value is the default. `value` must outlive `app`.
template <typename Value>
void add_choice(CLI::App& app, const std::string& option, Value& value, Choices<Value> choices,
                const std::string& help) {
  std::vector<std::string> names;
  std::string default_name;
  for (const auto& [name, choice] : choices) {
    names.push_back(name);
    if (choice == value) default_name = name;
  }
  const auto choose = [&value, choices = std::move(choices)](const std::string& name) {
    value = std::ranges::find(choices, name, &Choices<Value>::value_type::first)->second;
  };
  app.add_option_function<std::string>(option, choose, help)
      ->check(CLI::IsMember(names))
      ->default_str(default_name);
}

}  // namespace bevloc::evaluation
