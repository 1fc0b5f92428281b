#include "command/manual/option_table.h"

#include <sstream>

namespace bevloc::command {
namespace {

/// Reads a type such as "TEXT:{mock,v4l2}" or "TEXT:FILE". The part after the colon says what is
/// allowed.
void read_type(const std::string& type, OptionEntry& entry) {
  const size_t colon = type.find(':');
  entry.value = type.substr(0, colon);
  if (colon == std::string::npos) return;
  const std::string allowed = type.substr(colon + 1);
  if (allowed == "FILE" || allowed == "DIR") entry.value = allowed;
  if (allowed.size() < 2 || allowed.front() != '{' || allowed.back() != '}') return;
  std::istringstream words(allowed.substr(1, allowed.size() - 2));
  for (std::string word; std::getline(words, word, ',');) entry.choices.push_back(word);
}

OptionEntry entry_of(const CLI::Option& option) {
  OptionEntry entry;
  for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
  entry.positional = entry.names.empty();
  if (entry.positional) entry.names.push_back(option.get_name(true));
  entry.description = option.get_description();
  const bool is_flag = option.get_items_expected_max() == 0;
  if (!is_flag) read_type(option.get_type_name(), entry);
  entry.default_value = is_flag ? "" : option.get_default_str();
  entry.required = option.get_required();
  return entry;
}

void add_options(const CLI::App& app, CommandEntry& entry) {
  for (const CLI::Option* option : app.get_options([](const CLI::Option*) { return true; })) {
    entry.options.push_back(entry_of(*option));
  }
}

CommandEntry entry_of(const CLI::App& app, const std::string& path) {
  CommandEntry entry;
  entry.name = app.get_name();
  entry.path = path;
  entry.description = app.get_description();
  entry.footer = app.get_footer();
  add_options(app, entry);
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (sub->get_name().empty()) {
      add_options(*sub, entry);  // an option group
    } else if (!sub->get_group().empty()) {
      entry.commands.push_back(
          entry_of(*sub, path.empty() ? sub->get_name() : path + " " + sub->get_name()));
    }
  }
  return entry;
}

}  // namespace

CommandEntry table_of(const CLI::App& app) {
  return entry_of(app, "");
}

std::vector<const CommandEntry*> all_commands(const CommandEntry& command) {
  std::vector<const CommandEntry*> all{&command};
  for (const CommandEntry& sub : command.commands) {
    const auto below = all_commands(sub);
    all.insert(all.end(), below.begin(), below.end());
  }
  return all;
}

}  // namespace bevloc::command
