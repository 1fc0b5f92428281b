#include "command/command_list.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/output.h"

namespace bevloc::command {

int CommandList::run(CLI::App& app, int argc, char** argv) const {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadInput;
  }
  const auto entry = std::ranges::find_if(entries_, [](const Entry& e) { return e.chosen(); });
  if (entry == entries_.end()) return kBadInput;
  const Result<int> code = run_without_throwing(entry->run);
  const Status printed = code ? flush_output() : tl::unexpected(code.error());
  if (printed) return *code;
  std::fputs(fmt::format("bevloc: {}\n", printed.error().message).c_str(), stderr);
  return kBadInput;
}

}  // namespace bevloc::command
