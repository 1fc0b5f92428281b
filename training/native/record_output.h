// Writes records of samples to standard output, for another program.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace bevloc {

/// Fails if standard output is a terminal. Messages on standard error begin with `program`.
bool output_is_pipe(const std::string& program);

/// Writes all bytes to standard output. False when nobody reads any more or the write fails; then
/// the reason is on standard error.
bool write_output(std::span<const uint8_t> bytes, const std::string& program);

}  // namespace bevloc
