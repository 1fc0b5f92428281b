// Writes records of samples to standard output, for another program.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace bevloc {

/// Returns false if standard output is a terminal, and then prints a message of `program` to
/// standard error.
bool output_is_pipe(const std::string& program);

/// Writes all bytes to standard output. Returns false if the reader has gone or the write fails,
/// and prints the reason to standard error.
bool write_output(std::span<const uint8_t> bytes, const std::string& program);

}  // namespace bevloc
