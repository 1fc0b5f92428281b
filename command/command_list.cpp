#include "command/command_list.h"

#include <algorithm>

#include <fmt/format.h>

namespace bevloc::command {

int CommandList::run(CLI::App& app, int argc, char** argv) const {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadInput;
  }
  const auto entry = std::ranges::find_if(entries_, [](const Entry& e) { return e.chosen(); });
  if (entry == entries_.end()) return kBadInput;
  const Result<int> code = entry->run();
  if (code) return *code;
  fmt::print(stderr, "bevloc: {}\n", code.error().message);
  return kBadInput;
}

}  // namespace bevloc::command
