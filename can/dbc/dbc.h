// Reads DBC files, in which vehicle makers describe the messages and signals of their buses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "can/dbc/available_values.h"
#include "can/dbc/signal_layout.h"
#include "common/result.h"

namespace bevloc::can {

/// One line of VAL_: the name of a raw value.
struct DbcValueName {
  int64_t raw = 0;  ///< with the sign of the signal, as raw_from() returns it
  std::string name;
};

/// Whether a name of VAL_ means that the signal is not available: SNA or sna.
bool means_not_available(std::string_view value_name);

/// Raw values from `first` to `last`, both included.
struct DbcValueRange {
  uint64_t first = 0;
  uint64_t last = 0;

  bool operator==(const DbcValueRange&) const = default;
};

struct DbcSignal {
  std::string name;
  int line = 0;
  SignalLayout layout;
  double min = 0.0;  ///< physical; see has_range()
  double max = 0.0;
  std::string unit;
  bool is_multiplexor = false;  ///< the signal (M) says which multiplexed signals a frame has
  /// The signal is only in frames whose multiplexor has one of these values (mN, or SG_MUL_VAL_ in
  /// its place). If this is empty, it is in all frames.
  std::vector<DbcValueRange> multiplexed_at{};
  std::vector<DbcValueName> value_names{};

  /// The raw values that have this name.
  std::vector<int64_t> values_named(std::string_view value_name) const;
  /// Whether a frame with this raw value of the multiplexor has the signal.
  bool is_present_at(uint64_t multiplexor) const;
  /// Whether the file states a range: two limits that differ.
  bool has_range() const { return min != max; }
  /// The range has half a step more for whole numbers. So a limit that is written with few digits
  /// does not refuse the raw value that is nearest to it.
  AvailableValues available_values() const;
};

struct DbcMessage {
  std::string name;
  int line = 0;
  uint32_t id = 0;
  bool is_extended = false;  ///< an identifier of 29 bits
  uint8_t length = 0;        ///< in bytes; more than 8 on CAN FD only
  std::string sender;
  std::vector<DbcSignal> signals{};
  /// Values of BA_ for this message, and the defaults of the file (BA_DEF_DEF_). Values of ENUM
  /// attributes are names.
  std::map<std::string, std::string, std::less<>> attributes{};
  /// Whether the message has several multiplexors (mNM, or SG_MUL_VAL_ with another one). Then it
  /// is not known which multiplexed signals a frame has.
  bool nested_multiplexing = false;
  /// The error message that says why the message is left out. Such a message has no signals.
  std::string left_out{};

  /// Returns null if there is none.
  const DbcSignal* find(std::string_view signal_name) const;
  const DbcSignal* multiplexor() const;
  /// The attribute GenMsgCycleTime, or nothing if the file does not state it.
  std::optional<double> cycle_ms() const;
};

struct Dbc {
  std::string file;
  std::vector<DbcMessage> messages;
  /// Number of statements of each kind that say nothing about how frames are read (comments, nodes,
  /// environment variables and so on).
  std::map<std::string, size_t> skipped;

  /// Returns null if there is none.
  const DbcMessage* find(std::string_view message_name) const;
  const DbcMessage* find(uint32_t id, bool is_extended) const;
};

/// Reads BO_, SG_, VAL_, BA_ (of messages), SIG_VALTYPE_ and SG_MUL_VAL_, and skips and counts
/// other statements. Fails with "file:line: found X, wanted Y" for what it cannot read, for names
/// and identifiers of messages that occur twice, and for statements about missing messages or
/// signals. A message whose signals cannot be right is left out. Text that is not UTF-8 is read as
/// Latin-1. Errors show `name` as the file.
Result<Dbc> parse_dbc(std::string_view text, const std::string& name);
Result<Dbc> read_dbc_file(const std::filesystem::path& path);

}  // namespace bevloc::can
