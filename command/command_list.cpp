#include "command/command_list.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/option_checks.h"
#include "common/output.h"

namespace bevloc::command {

namespace {

/// Returns the message for a first word that is neither a command nor an option.
std::optional<std::string> unknown_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-' || has_command(app, argv[1])) return std::nullopt;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return fmt::format("bevloc: found the command \"{}\", wanted one of: {}\n", printable(argv[1]),
                     fmt::join(names, ", "));
}

}  // namespace

bool has_command(const CLI::App& app, const std::string& word) {
  return !app.get_subcommands(
                 [&word](const CLI::App* command) { return command->check_name(word); })
              .empty();
}

std::vector<const CLI::App*> CommandList::subcommands_of(
    std::initializer_list<const CLI::App*> parents) {
  std::vector<const CLI::App*> all;
  for (const CLI::App* parent : parents) {
    std::ranges::copy(parent->get_subcommands({}), std::back_inserter(all));
  }
  return all;
}

int CommandList::run(CLI::App& app, int argc, char** argv) const {
  if (const auto message = unknown_command(app, argc, argv)) {
    std::fputs(message->c_str(), stderr);
    return kBadInput;
  }
  if (const auto ended = parse_options(app, argc, argv)) return *ended;
  const auto entry = std::ranges::find_if(entries_, [](const Entry& candidate) {
    return std::ranges::any_of(candidate.subcommands, &CLI::App::parsed);
  });
  if (entry == entries_.end()) return kBadInput;
  const Result<int> code = run_without_throwing(entry->run);
  const Status printed = code ? flush_output() : tl::unexpected(code.error());
  if (printed) return *code;
  std::fputs(fmt::format("bevloc: {}\n", printable(printed.error().message)).c_str(), stderr);
  return kBadInput;
}

}  // namespace bevloc::command
