// Writes records of samples to standard output, for another program.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace bevloc {

/// False if standard output is a terminal; then a message of `program` is on standard error.
bool output_is_pipe(const std::string& program);

/// Writes all bytes to standard output. Returns false if the reader has gone or the write fails,
/// and prints the reason to standard error.
bool write_output(std::span<const uint8_t> bytes, const std::string& program);

}  // namespace bevloc
