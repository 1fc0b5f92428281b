#include "evaluation/command_output.h"

#include <fmt/format.h>
#include <unistd.h>

#include "common/files.h"

namespace bevloc::evaluation {

void show_progress(int done, int all, std::string_view what) {
  if (isatty(STDERR_FILENO) == 0) return;
  constexpr int kWidth = 40;
  fmt::print(stderr, "\r[{:<{}}] {}/{} {}{}", std::string(kWidth * done / all, '='), kWidth, done,
             all, what, done == all ? "\n" : "");
}

Status write_file(const std::string& text, const std::string& path) {
  if (path.empty()) return {};
  return bevloc::write_file(path, text);
}

}  // namespace bevloc::evaluation
