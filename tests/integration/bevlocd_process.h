// Runs the built bevlocd as a process, and helpers for its files.
#pragma once

#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.h"
#include "tests/support/text.h"

namespace bevloc::test {

struct ProcessResult {
  int exit_code = -1;  ///< 128 + signal number if a signal ended the process
  std::string out;
  std::string err;
};

/// Runs bevlocd and waits for its end. `launcher` precedes the program on the command line, such as
/// timeout(1) with its options.
ProcessResult run_bevlocd(const std::string& arguments, const std::string& launcher = "");

void write_file(const std::filesystem::path& file, const std::string& text);

/// Returns the shipped demo configuration with absolute paths, and with `piece` replaced.
std::string demo_config_with(const std::string& piece, const std::string& replacement);

}  // namespace bevloc::test
