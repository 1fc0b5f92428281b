// The progress bar of the commands of `bevloc`.
#pragma once

#include <string_view>

namespace bevloc::evaluation {

/// Updates a progress bar on stderr. Does nothing if stderr is not a terminal.
void show_progress(int done, int all, std::string_view what = "scenes");

}  // namespace bevloc::evaluation
