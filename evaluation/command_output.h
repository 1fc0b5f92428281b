// Progress display and output files of the commands of `bevloc`.
#pragma once

#include <string>
#include <string_view>

#include "common/result.h"

namespace bevloc::evaluation {

/// Updates a progress bar on stderr. Does nothing if stderr is not a terminal.
void show_progress(int done, int all, std::string_view what = "scenes");

/// Does nothing if `path` is empty.
Status write_file(const std::string& text, const std::string& path);

}  // namespace bevloc::evaluation
