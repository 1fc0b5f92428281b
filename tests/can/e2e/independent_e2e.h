// Checks the E2E protection of a candump log with only the DBC file: own CRC, own reader, no code
// of can/.
#pragma once

#include <cstdint>
#include <functional>
#include <istream>
#include <map>
#include <string>
#include <vector>

#include "tests/can/messages/dbc_parser.h"

namespace bevloc::test {

struct LoggedFrame {
  double time_s = 0.0;
  uint32_t id = 0;
  std::vector<uint8_t> bytes;
};

struct E2eTally {
  int good = 0;
  int wrong_crc = 0;
  int wrong_length = 0;
  int repeated = 0;
  int lost = 0;

  bool is_clean() const { return wrong_crc + wrong_length + repeated + lost == 0; }
};

struct E2eLogReport {
  std::map<std::string, E2eTally> by_message;  ///< only messages that occurred
  int unknown_frames = 0;                      ///< their identifier is not in the DBC file
  int unreadable_lines = 0;
};

/// CRC-8H2F bit by bit over bytes 1 to the last and the data id.
uint8_t expected_p02_crc(const std::vector<uint8_t>& bytes, uint8_t data_id);

/// CRC-16/CCITT-FALSE bit by bit over bytes 2 to the last and the data id, low byte first.
uint16_t expected_p05_crc(const std::vector<uint8_t>& bytes, uint16_t data_id);

/// Checks each frame of a log. Calls `on_good` for each frame that a consumer may use.
E2eLogReport check_candump_log(
    std::istream& log, const Dbc& dbc,
    const std::function<void(const DbcMessage&, const LoggedFrame&)>& on_good = {});

}  // namespace bevloc::test
