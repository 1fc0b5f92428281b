// Reads and writes logs of CAN frames in the format of candump -l and canplayer (can-utils).
#pragma once

#include <chrono>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "can/bus/error_frame.h"
#include "can/bus/frame.h"
#include "common/result.h"

namespace bevloc::can {

enum class CandumpKind : uint8_t {
  kData,      ///< a data frame with an 11-bit identifier, classic or FD
  kExtended,  ///< a data frame with a 29-bit identifier
  kRemote,    ///< a remote frame
  kError,     ///< an error report of the controller
};

/// One line of a log: `(1436509052.249713) can0 044#2A366C2BBA`. In a CAN FD line,
/// `... 044##12A366C2BBA`, one digit of flags precedes the data (1: data at the higher bit rate).
struct CandumpEntry {
  std::chrono::nanoseconds time{};  ///< since the epoch of the clock that wrote the log
  std::string interface;
  CandumpKind kind = CandumpKind::kData;
  Frame frame;       ///< valid only for kData
  ErrorFrame error;  ///< valid only for kError
};

enum class CandumpDigits : uint8_t {
  kMicroseconds = 6,  ///< every tool reads it; rounds towards zero
  kNanoseconds = 9,   ///< exact; read by bevloc and by canplayer since 2023
};

/// Returns the line without its line end. It does not depend on the locale. `time` must not be
/// negative.
std::string candump_line(std::chrono::nanoseconds time, std::string_view interface,
                         const Frame& frame, CandumpDigits digits = CandumpDigits::kMicroseconds);
std::string candump_line(std::chrono::nanoseconds time, std::string_view interface,
                         const ErrorFrame& error,
                         CandumpDigits digits = CandumpDigits::kMicroseconds);

/// Blanks may precede the interface, because candump aligns the names. Fails for a line of any
/// other form. The error names `place` ("file:line").
Result<CandumpEntry> parse_candump_line(std::string_view line, std::string_view place);

/// Reads a log line by line. It skips empty lines and those in which candump says that its socket
/// dropped frames (candump -d). One thread.
class CandumpReader {
 public:
  /// The log must outlive the reader. Errors show `name` as the file.
  CandumpReader(std::istream& log, std::string name) : log_(log), name_(std::move(name)) {}

  /// Returns nothing at the end of the log. Fails for a bad line, and names file:line.
  Result<std::optional<CandumpEntry>> next();

 private:
  std::istream& log_;
  std::string name_;
  int line_number_ = 0;
};

/// Reads a whole log. Fails at the first bad line.
Result<std::vector<CandumpEntry>> read_candump(std::istream& log, std::string_view name);
Result<std::vector<CandumpEntry>> read_candump_file(const std::string& path);

}  // namespace bevloc::can
