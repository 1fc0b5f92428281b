// What the engine runs in one call.
#pragma once

#include <string>
#include <vector>

namespace bevloc::nn {

/// Names of the outputs that one branch computes. A branch may read results of earlier branches.
using Branch = std::vector<std::string>;

}  // namespace bevloc::nn
