#include "evaluation/progress_bar.h"

#include <string>

#include <fmt/format.h>
#include <unistd.h>

namespace bevloc::evaluation {

void show_progress(int done, int all, std::string_view what) {
  if (isatty(STDERR_FILENO) == 0) return;
  constexpr int kWidth = 40;
  fmt::print(stderr, "\r[{:<{}}] {}/{} {}{}", std::string(kWidth * done / all, '='), kWidth, done,
             all, what, done == all ? "\n" : "");
}

}  // namespace bevloc::evaluation
