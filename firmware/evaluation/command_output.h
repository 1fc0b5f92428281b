// What the commands of `bevloc eval` have in common: progress and files.
#pragma once

#include <string>

#include "common/result.h"

namespace bevloc::evaluation {

/// A live line where somebody watches.
void show_progress(int done, int all);

/// Does nothing if `path` is empty.
Status write_file(const std::string& text, const std::string& path);

}  // namespace bevloc::evaluation
