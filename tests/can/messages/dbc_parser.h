// Reads a DBC file without any code of can/, so that it can check can/.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace bevloc::test {

struct DbcSignal {
  std::string name;
  int start_bit = 0;
  int length_bits = 0;
  bool is_signed = false;
  double scale = 1.0;
  double offset = 0.0;
  double min = 0.0;
  double max = 0.0;
  std::string unit;
  std::map<int64_t, std::string> value_names;
  std::string comment;

  /// Reads the signal bit by bit, in Intel byte order.
  int64_t raw_from(std::span<const uint8_t> bytes) const;
  double physical_from(std::span<const uint8_t> bytes) const;
  bool is_sna(std::span<const uint8_t> bytes) const;
};

struct DbcMessage {
  uint32_t id = 0;
  std::string name;
  int length = 0;
  std::vector<DbcSignal> signals;
  std::map<std::string, int> attributes;
  std::map<std::string, std::string> texts;  ///< attributes that are texts

  /// Throws std::out_of_range if there is no such signal.
  const DbcSignal& signal(const std::string& signal_name) const;
};

struct Dbc {
  std::map<uint32_t, DbcMessage> messages;

  const DbcMessage& message(const std::string& name) const;
};

/// Throws std::runtime_error, which quotes the line, for a line that it cannot read.
Dbc parse_dbc(const std::string& text);
Dbc load_dbc(const std::string& path);

}  // namespace bevloc::test
