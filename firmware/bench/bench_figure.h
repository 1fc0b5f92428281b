// Where the time of a frame goes, as a picture.
#pragma once

#include <string>

#include "common/result.h"
#include "firmware/bench/measurement.h"

namespace bevloc::bench {

/// A bar for each stage of the frame: the median, a line to the 99th percentile, and a mark at the
/// ideal time. As PNG. Needs a result with a whole frame.
Status draw_bars(const BenchResult& result, const std::string& path);

}  // namespace bevloc::bench
