// `bevloc status`: asks a running daemon for its status and prints it.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace bevloc::command {

/// Reads /status.json of a daemon with the section `live`. One thread.
class StatusCommand {
 public:
  // Exit codes.
  static constexpr int kValid = 0;
  static constexpr int kNotValid = 1;
  static constexpr int kNotReachable = 2;

  void declare(CLI::App& app);

  /// Prints the page, or with --json what the daemon sent, on stdout. Prints one line on stderr if
  /// the daemon is not reachable or does not answer as it should. Returns the exit code.
  int run() const;

 private:
  std::string address_ = "127.0.0.1";
  int port_ = 8080;
  bool json_ = false;
};

}  // namespace bevloc::command
