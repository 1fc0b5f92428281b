#include "tests/integration/bevlocd_process.h"

#include <cstdlib>
#include <fstream>

#include <sys/wait.h>

#include "tests/support/temporary_folder.h"

namespace bevloc::test {

ProcessResult run_bevlocd(const std::string& arguments, const std::string& launcher) {
  const TemporaryFolder scratch;
  const std::string command = launcher + " " + BEVLOCD_PROGRAM + " " + arguments + " >" +
                              (scratch / "out").string() + " 2>" + (scratch / "err").string();
  const int status = std::system(command.c_str());
  ProcessResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = read_text(scratch / "out");
  result.err = read_text(scratch / "err");
  return result;
}

void write_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

std::string demo_config_with(const std::string& piece, const std::string& replacement) {
  const std::filesystem::path root = BEVLOC_SOURCE_DIR;
  std::string text = read_text(root / "config" / "demo.yaml");
  text = replaced(text, "rig_demo.yaml", (root / "config" / "rig_demo.yaml").string());
  text = replaced(text, "../models/", (root / "models").string() + "/");
  return replaced(text, piece, replacement);
}

}  // namespace bevloc::test
