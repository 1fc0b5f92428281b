// Logs of CAN frames in the format of candump -l and canplayer (can-utils).
#pragma once

#include <chrono>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "can/error_frame.h"
#include "can/frame.h"
#include "common/result.h"

namespace bevloc::can {

enum class CandumpKind : uint8_t {
  kData,      ///< a data frame with an 11-bit identifier, classic or FD
  kExtended,  ///< a data frame with a 29-bit identifier
  kRemote,    ///< a remote frame
  kError,     ///< an error report of the controller
};

/// One line: `(1436509052.249713) can0 044#2A366C2BBA`, on FD `... 044##12A366C2BBA` with the
/// flags (1: the data at the higher bit rate) before the data.
struct CandumpEntry {
  std::chrono::nanoseconds time{};  ///< since the zero of whatever clock the log was written with
  std::string interface;
  CandumpKind kind = CandumpKind::kData;
  Frame frame;       ///< meaningful for kData alone
  ErrorFrame error;  ///< meaningful for kError alone
};

enum class CandumpDigits : uint8_t {
  kMicroseconds = 6,  ///< read by every tool; rounds towards zero
  kNanoseconds = 9,   ///< exact; read by canplayer of 2023 and later, and by us
};

/// The line without its end. The same in every locale. The time is not negative.
std::string candump_line(std::chrono::nanoseconds time, std::string_view interface,
                         const Frame& frame, CandumpDigits digits = CandumpDigits::kMicroseconds);
std::string candump_line(std::chrono::nanoseconds time, std::string_view interface,
                         const ErrorFrame& error,
                         CandumpDigits digits = CandumpDigits::kMicroseconds);

/// Fails on a line that is none of the kinds, naming `place` ("file:line").
Result<CandumpEntry> parse_candump_line(std::string_view line, std::string_view place);

/// All lines of a log; empty lines are skipped. Fails at the first bad line with file:line.
Result<std::vector<CandumpEntry>> read_candump(std::istream& log, std::string_view name);
Result<std::vector<CandumpEntry>> read_candump_file(const std::string& path);

}  // namespace bevloc::can
