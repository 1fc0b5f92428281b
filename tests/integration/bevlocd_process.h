// Runs the built bevlocd as a process, and helpers for its files.
#pragma once

#include <filesystem>
#include <string>

namespace bevloc::test {

struct ProcessResult {
  int exit_code = -1;  ///< 128 + signal number if a signal ended the process
  std::string out;
  std::string err;
};

/// A new empty folder, which the destructor removes.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Runs bevlocd and waits for its end. `launcher` precedes the program on the command line, such as
/// timeout(1) with its options.
ProcessResult run_bevlocd(const std::string& arguments, const std::string& launcher = "");

std::string read_text(const std::filesystem::path& file);
void write_file(const std::filesystem::path& file, const std::string& text);

/// Returns the shipped demo configuration with absolute paths, and with `piece` replaced.
std::string demo_config_with(const std::string& piece, const std::string& replacement);

}  // namespace bevloc::test
