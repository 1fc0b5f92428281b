#include "tests/integration/bevlocd_process.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "tests/support/temporary_folder.h"

namespace bevloc::test {
namespace {

std::string with_replaced(std::string text, const std::string& piece,
                          const std::string& replacement) {
  const size_t at = text.find(piece);
  EXPECT_NE(at, std::string::npos) << "not in the demo configuration: " << piece;
  return text.replace(at, piece.size(), replacement);
}

}  // namespace

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

std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  EXPECT_TRUE(stream) << file;
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

void write_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

std::string demo_config_with(const std::string& piece, const std::string& replacement) {
  const std::filesystem::path root = BEVLOC_SOURCE_DIR;
  std::string text = read_text(root / "config" / "demo.yaml");
  text = with_replaced(text, "rig_demo.yaml", (root / "config" / "rig_demo.yaml").string());
  text = with_replaced(text, "../models/", (root / "models").string() + "/");
  return with_replaced(text, piece, replacement);
}

}  // namespace bevloc::test
