// The table of the commands of `bevloc`, in which one line registers a command.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::command {

/// The result of a command that judges something. Its value is the exit code.
enum class Verdict : uint8_t {
  kGood = 0,
  kBad = 1,  ///< the judged thing is not good enough
};

/// Whether the program has a command of this name.
bool has_command(const CLI::App& app, const std::string& word);

/// Holds the commands and runs the one that the command line names. A command is a class with
///
///     void declare(CLI::App& parent);  // or more parents; adds one subcommand or more
///     Status run();                    // or Result<Verdict>, or Result<int>: an exit code
///
/// One thread.
class CommandList {
 public:
  /// Makes a command and declares it under `parents`, as in add<FaultCommand>(app). add_with() also
  /// passes an argument to the constructor, as in add_with<SchemaCommand>(reader, app).
  template <typename Command, typename... Parents>
  void add(Parents&... parents) {
    keep(std::make_shared<Command>(), parents...);
  }
  template <typename Command, typename Argument, typename... Parents>
  void add_with(Argument&& argument, Parents&... parents) {
    keep(std::make_shared<Command>(std::forward<Argument>(argument)), parents...);
  }

  /// Parses the command line and runs the command that it names. Returns the exit code: 0 for good,
  /// 1 for judged bad, and 2 with one line on stderr for wrong use or input.
  int run(CLI::App& app, int argc, char** argv) const;

 private:
  struct Entry {
    std::vector<const CLI::App*> subcommands;  ///< the command runs if one of them is parsed
    std::function<Result<int>()> run;
  };

  template <typename Command, typename... Parents>
  void keep(std::shared_ptr<Command> command, Parents&... parents) {
    const auto before = subcommands_of({&parents...});
    command->declare(parents...);
    auto declared = subcommands_of({&parents...});
    std::erase_if(declared, [&before](const CLI::App* subcommand) {
      return std::ranges::find(before, subcommand) != before.end();
    });
    entries_.push_back({std::move(declared), [command] { return exit_code(command->run()); }});
  }

  static std::vector<const CLI::App*> subcommands_of(
      std::initializer_list<const CLI::App*> parents);

  static Result<int> exit_code(const Status& status) {
    return status ? Result<int>(0) : Result<int>(tl::unexpected(status.error()));
  }
  static Result<int> exit_code(const Result<Verdict>& verdict) {
    return verdict.map([](Verdict value) { return static_cast<int>(value); });
  }
  static Result<int> exit_code(const Result<int>& code) { return code; }

  std::vector<Entry> entries_;
};

}  // namespace bevloc::command
