#include "command/command_list.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/option_checks.h"
#include "common/output.h"

namespace bevloc::command {

int CommandList::run(CLI::App& app, int argc, char** argv) const {
  if (const auto ended = parse_options(app, argc, argv)) return *ended;
  const auto entry = std::ranges::find_if(entries_, [](const Entry& e) { return e.chosen(); });
  if (entry == entries_.end()) return kBadInput;
  const Result<int> code = run_without_throwing(entry->run);
  const Status printed = code ? flush_output() : tl::unexpected(code.error());
  if (printed) return *code;
  std::fputs(fmt::format("bevloc: {}\n", printable(printed.error().message)).c_str(), stderr);
  return kBadInput;
}

}  // namespace bevloc::command
