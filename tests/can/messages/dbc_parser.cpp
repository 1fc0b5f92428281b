#include "tests/can/messages/dbc_parser.h"

#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace bevloc::test {
namespace {

/// Reads one line from left to right.
class Scanner {
 public:
  explicit Scanner(const std::string& line) : line_(line) {}

  bool take(std::string_view literal) {
    if (!std::string_view(line_).substr(position_).starts_with(literal)) return false;
    position_ += literal.size();
    return true;
  }

  void expect(std::string_view literal) {
    if (!take(literal))
      throw std::runtime_error("wanted '" + std::string(literal) + "' in: " + line_);
  }

  /// Reads up to and including `end` and returns the text before it.
  std::string until(std::string_view end) {
    const size_t found = line_.find(end, position_);
    if (found == std::string::npos) {
      throw std::runtime_error("wanted '" + std::string(end) + "' in: " + line_);
    }
    const std::string text = line_.substr(position_, found - position_);
    position_ = found + end.size();
    return text;
  }

  double number_until(std::string_view end) { return std::stod(until(end)); }
  int integer_until(std::string_view end) { return std::stoi(until(end)); }
  uint32_t id_until(std::string_view end) { return static_cast<uint32_t>(std::stoul(until(end))); }

 private:
  const std::string& line_;
  size_t position_ = 0;
};

/// `BO_ 1280 LOC_Status: 8 LOCALIZER`
DbcMessage parse_message(const std::string& line) {
  Scanner scanner(line);
  DbcMessage message;
  scanner.expect("BO_ ");
  message.id = scanner.id_until(" ");
  message.name = scanner.until(": ");
  message.length = scanner.integer_until(" ");
  return message;
}

/// ` SG_ State : 16|4@1+ (1,0) [0|5] "" VEHICLE`
DbcSignal parse_signal(const std::string& line) {
  Scanner scanner(line);
  DbcSignal signal;
  scanner.expect(" SG_ ");
  signal.name = scanner.until(" : ");
  signal.start_bit = scanner.integer_until("|");
  signal.length_bits = scanner.integer_until("@1");
  signal.is_signed = scanner.take("-");
  if (!signal.is_signed) scanner.expect("+");
  scanner.expect(" (");
  signal.scale = scanner.number_until(",");
  signal.offset = scanner.number_until(") [");
  signal.min = scanner.number_until("|");
  signal.max = scanner.number_until("] \"");
  signal.unit = scanner.until("\" ");
  return signal;
}

DbcSignal& signal_of(Dbc& dbc, uint32_t id, const std::string& name) {
  for (DbcSignal& signal : dbc.messages.at(id).signals) {
    if (signal.name == name) return signal;
  }
  throw std::runtime_error("no signal " + name + " in message " + std::to_string(id));
}

/// `VAL_ 1280 State 0 "INIT" 1 "ACQUIRING" ;`
void parse_values(Dbc& dbc, const std::string& line) {
  Scanner scanner(line);
  scanner.expect("VAL_ ");
  const uint32_t id = scanner.id_until(" ");
  DbcSignal& signal = signal_of(dbc, id, scanner.until(" "));
  while (!scanner.take(";")) {
    const int64_t raw = std::stoll(scanner.until(" \""));
    signal.value_names[raw] = scanner.until("\" ");
  }
}

/// `BA_ "E2EDataId" BO_ 1280 81;`. Attributes of signals are skipped.
void parse_attribute(Dbc& dbc, const std::string& line) {
  Scanner scanner(line);
  scanner.expect("BA_ \"");
  const std::string name = scanner.until("\" ");
  if (!scanner.take("BO_ ")) return;
  const uint32_t id = scanner.id_until(" ");
  if (scanner.take("\"")) {
    dbc.messages.at(id).texts[name] = scanner.until("\";");
    return;
  }
  dbc.messages.at(id).attributes[name] = scanner.integer_until(";");
}

/// `CM_ SG_ 1280 State "What it means.";`
void parse_comment(Dbc& dbc, const std::string& line) {
  Scanner scanner(line);
  scanner.expect("CM_ SG_ ");
  const uint32_t id = scanner.id_until(" ");
  DbcSignal& signal = signal_of(dbc, id, scanner.until(" \""));
  signal.comment = scanner.until("\";");
}

}  // namespace

int64_t DbcSignal::raw_from(std::span<const uint8_t> bytes) const {
  int64_t raw = 0;
  int64_t weight = 1;
  for (int i = 0; i < length_bits; ++i, weight *= 2) {
    const int bit = start_bit + i;
    const bool set = (bytes[static_cast<size_t>(bit / 8)] >> (bit % 8)) % 2 != 0;
    if (!set) continue;
    const bool is_sign = is_signed && i == length_bits - 1;
    raw += is_sign ? -weight : weight;
  }
  return raw;
}

double DbcSignal::physical_from(std::span<const uint8_t> bytes) const {
  return static_cast<double>(raw_from(bytes)) * scale + offset;
}

bool DbcSignal::is_sna(std::span<const uint8_t> bytes) const {
  const auto name_of_value = value_names.find(raw_from(bytes));
  return name_of_value != value_names.end() && name_of_value->second == "SNA";
}

const DbcSignal& DbcMessage::signal(const std::string& signal_name) const {
  for (const DbcSignal& candidate : signals) {
    if (candidate.name == signal_name) return candidate;
  }
  throw std::out_of_range("no signal " + signal_name + " in " + name);
}

const DbcMessage& Dbc::message(const std::string& name) const {
  for (const auto& [id, candidate] : messages) {
    if (candidate.name == name) return candidate;
  }
  throw std::out_of_range("no message " + name);
}

Dbc parse_dbc(const std::string& text) {
  Dbc dbc;
  DbcMessage* current = nullptr;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("BO_ ")) {
      const DbcMessage message = parse_message(line);
      const auto [place, is_new] = dbc.messages.emplace(message.id, message);
      if (!is_new) throw std::runtime_error("second message with this identifier: " + line);
      current = &place->second;
    } else if (line.starts_with(" SG_ ")) {
      if (current == nullptr) throw std::runtime_error("signal without message: " + line);
      current->signals.push_back(parse_signal(line));
    } else if (line.starts_with("VAL_ ")) {
      parse_values(dbc, line);
    } else if (line.starts_with("BA_ ")) {
      parse_attribute(dbc, line);
    } else if (line.starts_with("CM_ SG_ ")) {
      parse_comment(dbc, line);
    }
  }
  return dbc;
}

Dbc load_dbc(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot open " + path);
  return parse_dbc(std::string(std::istreambuf_iterator<char>(file), {}));
}

}  // namespace bevloc::test
