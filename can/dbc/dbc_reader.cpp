#include "can/dbc/dbc_reader.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "can/bus/frame.h"
#include "common/number_text.h"

namespace bevloc::can {
namespace {

constexpr uint32_t kExtendedFlag = 0x80000000;
/// The pseudo message that holds signals without a message.
constexpr uint32_t kNoMessage = 0xC0000000;
constexpr uint32_t kHighestExtendedId = 0x1FFFFFFF;

constexpr std::string_view kKeywords[] = {"VERSION",
                                          "NS_",
                                          "BS_",
                                          "BU_",
                                          "VAL_TABLE_",
                                          "BO_",
                                          "SG_",
                                          "BO_TX_BU_",
                                          "EV_",
                                          "ENVVAR_DATA_",
                                          "SGTYPE_",
                                          "SIG_GROUP_",
                                          "CM_",
                                          "BA_DEF_",
                                          "BA_DEF_DEF_",
                                          "BA_DEF_SGTYPE_",
                                          "BA_SGTYPE_",
                                          "BA_",
                                          "VAL_",
                                          "SIG_VALTYPE_",
                                          "SG_MUL_VAL_",
                                          "BA_DEF_REL_",
                                          "BA_REL_",
                                          "BA_DEF_DEF_REL_",
                                          "BU_SG_REL_",
                                          "BU_EV_REL_",
                                          "BU_BO_REL_",
                                          "SIG_TYPE_REF_",
                                          "SIGTYPE_VALTYPE_",
                                          "CAT_DEF_",
                                          "CAT_",
                                          "FILTER",
                                          "DBC_DEF_"};

bool is_keyword(const DbcToken& token) {
  return token.kind == DbcToken::Kind::kWord &&
         std::ranges::find(kKeywords, token.text) != std::end(kKeywords);
}

/// Whether the word consists of letters, digits and '_', as keywords do.
bool is_name(const DbcToken& token) {
  return token.kind == DbcToken::Kind::kWord && std::ranges::all_of(token.text, [](char c) {
           return c == '_' || (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') ||
                  (c >= 'a' && c <= 'z');
         });
}

bool starts_messages(const DbcToken& token) {
  return token.is_word("BO_") || token.is_word("SG_");
}

}  // namespace

std::string DbcReader::take_word(std::string_view wanted) {
  if (tokens_.peek().kind != DbcToken::Kind::kWord) refuse(tokens_.peek(), wanted);
  return tokens_.take().text;
}

void DbcReader::take_sign(char sign) {
  if (!tokens_.peek().is_sign(sign)) refuse(tokens_.peek(), fmt::format("'{}'", sign));
  tokens_.take();
}

double DbcReader::take_number(std::string_view wanted) {
  const DbcToken token = tokens_.take();
  std::string_view text = token.text;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto value = parse_number<double>(text);
  const bool good = token.kind == DbcToken::Kind::kWord && value && std::isfinite(*value);
  if (!good) refuse(token, wanted);
  return *value;
}

uint64_t DbcReader::unsigned_of(const DbcToken& token, std::string_view wanted) const {
  const auto value = parse_number<uint64_t>(token.text);
  if (token.kind != DbcToken::Kind::kWord || !value) refuse(token, wanted);
  return *value;
}

uint64_t DbcReader::take_unsigned(std::string_view wanted) {
  return unsigned_of(tokens_.take(), wanted);
}

/// Takes a raw value from -2^63 to 2^64 - 1.
int64_t DbcReader::take_raw() {
  if (!tokens_.peek().text.starts_with('-')) {
    return static_cast<int64_t>(take_unsigned("a raw value"));
  }
  const DbcToken token = tokens_.take();
  const auto value = parse_number<int64_t>(token.text);
  if (!value) refuse(token, "a raw value");
  return *value;
}

bool DbcReader::next_is_number() const {
  const DbcToken& token = tokens_.peek();
  return token.kind == DbcToken::Kind::kWord && token.text[0] >= '0' && token.text[0] <= '9';
}

/// Takes the identifier of a message and returns the message, or null for the pseudo message.
DbcMessage* DbcReader::take_message() {
  const DbcToken token = tokens_.take();
  const uint64_t raw = unsigned_of(token, "the identifier of a message");
  if (raw == kNoMessage) return nullptr;
  const auto id = static_cast<uint32_t>(raw & ~uint64_t{kExtendedFlag});
  const bool extended = (raw & kExtendedFlag) != 0;
  const auto found = std::ranges::find_if(dbc_.messages, [&](const DbcMessage& message) {
    return message.id == id && message.is_extended == extended;
  });
  if (raw > UINT32_MAX || found == dbc_.messages.end()) {
    refuse(token, "the identifier of a message of this file");
  }
  return &*found;
}

DbcSignal* DbcReader::take_signal_of(DbcMessage* message) {
  const DbcToken token = tokens_.peek();
  const std::string name = take_word("the name of a signal");
  if (message == nullptr) return nullptr;
  const auto found = std::ranges::find(message->signals, name, &DbcSignal::name);
  if (found == message->signals.end()) {
    refuse(token, fmt::format("the name of a signal of message {}", message->name));
  }
  return &*found;
}

void DbcReader::read_statement() {
  const DbcToken token = tokens_.take();
  if (token.is_sign(';')) return;
  if (!is_keyword(token)) return skip_unknown(token);
  const std::string& keyword = token.text;
  if (keyword == "BO_") return read_message();
  if (keyword == "VAL_") return read_value_names();
  if (keyword == "BA_DEF_") return read_attribute_definition();
  if (keyword == "BA_DEF_DEF_") return read_attribute_default();
  if (keyword == "BA_") return read_attribute();
  if (keyword == "SIG_VALTYPE_") return read_value_type();
  if (keyword == "SG_MUL_VAL_") return read_multiplexor_values();
  if (keyword == "SG_") refuse(token, "signals right after their message");
  if (keyword == "NS_" || keyword == "BU_" || keyword == "BS_" || keyword == "VERSION") {
    return skip_list(keyword);
  }
  skip_statement(keyword);
}

/// Skips to the semicolon. Fails if a message begins before it.
void DbcReader::skip_statement(const std::string& keyword) {
  ++dbc_.skipped[keyword];
  while (!tokens_.peek().is_sign(';')) {
    const DbcToken& next = tokens_.peek();
    const bool is_message = next.starts_line && starts_messages(next);
    if (next.kind == DbcToken::Kind::kEnd || is_message) refuse(next, "';'");
    tokens_.take();
  }
  tokens_.take();
}

/// Skips a statement that begins with an unknown word, if it ends with a semicolon.
void DbcReader::skip_unknown(const DbcToken& first) {
  bool good = first.starts_line && is_name(first);
  while (good && !tokens_.peek().is_sign(';')) {
    const DbcToken next = tokens_.take();
    good = next.kind != DbcToken::Kind::kEnd && !(next.starts_line && is_keyword(next));
  }
  if (!good) refuse(first, "a keyword of DBC files, such as BO_ or VAL_");
  ++dbc_.skipped[first.text];
  tokens_.take();
}

/// Skips a statement without a semicolon. The list of NS_ holds keywords itself; it ends where one
/// of the sections BS_ or BU_ begins. In BU_, a node may have the name of a keyword.
void DbcReader::skip_list(const std::string& keyword) {
  ++dbc_.skipped[keyword];
  while (tokens_.peek().kind != DbcToken::Kind::kEnd) {
    const DbcToken& next = tokens_.peek();
    const bool is_section = next.is_word("BS_") || next.is_word("BU_") || next.is_word("BO_");
    bool is_end = is_keyword(next);
    if (keyword == "NS_") is_end = is_section && next.starts_line;
    if (keyword == "BU_") is_end = is_end && (next.starts_line || starts_messages(next));
    if (is_end) return;
    tokens_.take();
  }
}

void DbcReader::read_message() {
  DbcMessage message;
  message.line = tokens_.peek().line;
  const uint64_t raw = take_unsigned("the identifier of a message");
  message.name = take_word("the name of a message");
  take_sign(':');
  const uint64_t length = take_unsigned("a number of bytes");
  message.sender = take_word("the sender of the message");
  const bool is_pseudo = raw == kNoMessage;
  message.is_extended = raw <= UINT32_MAX && (raw & kExtendedFlag) != 0;
  message.id = static_cast<uint32_t>(raw & ~uint64_t{kExtendedFlag});
  const uint32_t highest = message.is_extended ? kHighestExtendedId : kMaxStandardId;
  if (!is_pseudo) {
    if (raw > UINT32_MAX || message.id > highest) {
      refuse(message.line, fmt::format("identifier {}", raw),
             "at most 2047, or 29 bits plus 2147483648");
    }
    if (length > kMaxFdLength) {
      leave_out(message, message.line, fmt::format("{} bytes", length), "at most 64");
    }
    if (!ids_.insert(raw).second) {
      refuse(message.line, fmt::format("identifier {} a second time", raw), "each identifier once");
    }
    if (!names_.insert(message.name).second) {
      refuse(message.line, fmt::format("message {} a second time", message.name), "each name once");
    }
  }
  message.length = static_cast<uint8_t>(std::min<uint64_t>(length, kMaxFdLength));
  while (tokens_.peek().is_word("SG_")) {
    read_signal(message);
  }
  if (is_pseudo) {
    ++dbc_.skipped["BO_ (signals without a message)"];
    return;
  }
  dbc_.messages.push_back(std::move(message));
}

void DbcReader::read_multiplexing(DbcSignal& signal, DbcMessage& message) {
  if (tokens_.peek().kind != DbcToken::Kind::kWord) return;
  const DbcToken token = tokens_.take();
  std::string_view text = token.text;
  if (text.ends_with('M')) {
    signal.is_multiplexor = true;
    text.remove_suffix(1);
  }
  if (text.empty()) return;
  const auto value = parse_number<uint64_t>(std::string_view(text).substr(1));
  if (text[0] != 'm' || !value) refuse(token, "':', or M or m with a number for multiplexing");
  signal.multiplexed_at = {{*value, *value}};
  if (signal.is_multiplexor) message.nested_multiplexing = true;
}

void DbcReader::read_signal(DbcMessage& message) {
  tokens_.take();
  DbcSignal signal;
  signal.line = tokens_.peek().line;
  signal.name = take_word("the name of a signal");
  read_multiplexing(signal, message);
  take_sign(':');
  SignalLayout& layout = signal.layout;
  layout.start_bit = static_cast<int>(std::min<uint64_t>(take_unsigned("a start bit"), 1024));
  take_sign('|');
  layout.length_bits =
      static_cast<int>(std::min<uint64_t>(take_unsigned("a number of bits"), 1024));
  take_sign('@');
  const DbcToken order = tokens_.take();
  const bool valid = order.kind == DbcToken::Kind::kWord && order.text.size() == 2 &&
                     (order.text[0] == '0' || order.text[0] == '1') &&
                     (order.text[1] == '+' || order.text[1] == '-');
  if (!valid) refuse(order, "byte order and sign: 0+, 0-, 1+ or 1-");
  layout.order = order.text[0] == '0' ? ByteOrder::kMotorola : ByteOrder::kIntel;
  layout.type = order.text[1] == '-' ? RawType::kSigned : RawType::kUnsigned;
  take_sign('(');
  layout.scale = take_number("a scale");
  take_sign(',');
  layout.offset = take_number("an offset");
  take_sign(')');
  take_sign('[');
  signal.min = take_number("a minimum");
  take_sign('|');
  signal.max = take_number("a maximum");
  take_sign(']');
  if (tokens_.peek().kind != DbcToken::Kind::kText) refuse(tokens_.peek(), "a unit in quotes");
  signal.unit = tokens_.take().text;
  skip_receivers();
  check_signal(signal, message);
  message.signals.push_back(std::move(signal));
}

/// Skips names with commas between them. Accepts a file that has no receivers here, or blanks in
/// place of commas.
void DbcReader::skip_receivers() {
  const auto ends = [this] {
    const DbcToken& next = tokens_.peek();
    return next.kind != DbcToken::Kind::kWord || starts_messages(next) ||
           (next.starts_line && is_keyword(next));
  };
  if (ends()) return;
  do {
    tokens_.take();
    while (tokens_.peek().is_sign(',')) {
      tokens_.take();
      if (ends()) refuse(tokens_.peek(), "the name of a receiver");
      tokens_.take();
    }
  } while (!ends() && !tokens_.peek().starts_line);
  if (tokens_.peek().is_sign(';')) tokens_.take();
}

/// Notes the first mistake of a message.
void DbcReader::leave_out(DbcMessage& message, int line, std::string_view found,
                          std::string_view wanted) const {
  if (message.left_out.empty()) message.left_out = mistake(line, found, wanted);
}

void DbcReader::check_signal(const DbcSignal& signal, DbcMessage& message) const {
  const SignalLayout& layout = signal.layout;
  if (layout.length_bits < 1 || layout.length_bits > 64) {
    leave_out(message, signal.line,
              fmt::format("signal {} with {} bits", signal.name, layout.length_bits), "1 to 64");
  }
  if (bytes_needed(layout) > message.length) {
    leave_out(message, signal.line,
              fmt::format("signal {} up to byte {}", signal.name, bytes_needed(layout)),
              fmt::format("within the {} bytes of message {}", message.length, message.name));
  }
  if (layout.scale == 0.0) {
    leave_out(message, signal.line, fmt::format("signal {} with scale 0", signal.name),
              "another scale");
  }
  if (signal.min > signal.max) {
    leave_out(message, signal.line,
              fmt::format("signal {} from {} to {}", signal.name, signal.min, signal.max),
              "the smaller value first");
  }
  if (message.find(signal.name) != nullptr) {
    leave_out(message, signal.line, fmt::format("signal {} a second time", signal.name),
              "each name once");
  }
}

void DbcReader::check_multiplexors(DbcMessage& message) const {
  if (message.nested_multiplexing) return;
  const auto multiplexors = std::ranges::count_if(message.signals, &DbcSignal::is_multiplexor);
  const bool is_multiplexed = std::ranges::any_of(
      message.signals, [](const DbcSignal& signal) { return !signal.multiplexed_at.empty(); });
  if (multiplexors > 1 || (is_multiplexed && multiplexors == 0)) {
    leave_out(message, message.line,
              fmt::format("message {} with {} multiplexors", message.name, multiplexors),
              "one multiplexor (M) beside multiplexed signals");
  }
}

}  // namespace bevloc::can
