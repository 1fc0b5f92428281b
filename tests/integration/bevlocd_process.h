// Runs the bevlocd that was built, as a user or a service manager would.
#pragma once

#include <filesystem>
#include <string>

namespace bevloc::test {

struct ProcessResult {
  int exit_code = -1;  ///< 128 + signal number when a signal ended it
  std::string out;
  std::string err;
};

/// A folder of its own for one test, empty at first and removed at the end.
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

/// Waits for its end. `launcher` is put before the program, such as timeout(1) with its options.
ProcessResult run_bevlocd(const std::string& arguments, const std::string& launcher = "");

std::string read_text(const std::filesystem::path& file);
void write_file(const std::filesystem::path& file, const std::string& text);

/// The shipped demo configuration with its paths made absolute and one piece of text replaced.
std::string demo_config_with(const std::string& piece, const std::string& replacement);

}  // namespace bevloc::test
