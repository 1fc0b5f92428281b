// Faults as text: `gnss_jump from_s=20 until_s=30 east_m=5`.
#pragma once

#include <string>
#include <string_view>

#include "common/result.h"
#include "sim/faults/fault.h"

namespace bevloc::sim {

/// Reads a kind and, after it, words KEY=VALUE in any order: from_s (default: `now_s`), until_s or
/// for_s (default: for ever), camera, with, and the amounts of the kind.
Result<Fault> parse_fault(std::string_view text, double now_s);

/// The text from which parse_fault() makes this fault.
std::string to_text(const Fault& fault);

}  // namespace bevloc::sim
