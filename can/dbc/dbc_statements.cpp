// The statements of DBC files about messages and signals that were read before.
#include <algorithm>
#include <charconv>
#include <optional>

#include "can/dbc/dbc_reader.h"

namespace bevloc::can {
namespace {

/// Returns the raw value that the bits of `raw` mean in this layout, or nothing if they do not fit.
/// Some tools write the values of a signed signal without a sign: 32768 for -32768 in 16 bits.
std::optional<int64_t> raw_in(const SignalLayout& layout, int64_t raw) {
  const int unused = 64 - layout.length_bits;
  const auto bits = static_cast<uint64_t>(raw) << unused;
  const int64_t as_signed = static_cast<int64_t>(bits) >> unused;
  const auto as_unsigned = static_cast<int64_t>(bits >> unused);
  if (raw != as_signed && raw != as_unsigned) return std::nullopt;
  return layout.type == RawType::kSigned ? as_signed : as_unsigned;
}

}  // namespace

void DbcReader::read_value_names() {
  if (!next_is_number()) return skip_statement("VAL_ (environment variable)");
  DbcMessage* message = take_message();
  DbcSignal* signal = take_signal_of(message);
  while (!tokens_.peek().is_sign(';')) {
    DbcValueName value;
    value.raw = take_raw();
    if (tokens_.peek().kind != DbcToken::Kind::kText) {
      refuse(tokens_.peek(), "the name of a value in quotes");
    }
    value.name = tokens_.take().text;
    if (signal != nullptr) signal->value_names.push_back(std::move(value));
  }
  tokens_.take();
}

void DbcReader::read_value_type() {
  DbcMessage* message = take_message();
  DbcSignal* signal = take_signal_of(message);
  if (tokens_.peek().is_sign(':')) tokens_.take();
  const DbcToken token = tokens_.peek();
  const uint64_t type = take_unsigned("0 (integer), 1 (float) or 2 (double)");
  if (type > 2) refuse(token, "0 (integer), 1 (float) or 2 (double)");
  take_sign(';');
  if (signal == nullptr || type == 0) return;
  const int bits = type == 1 ? 32 : 64;
  if (signal->layout.length_bits != bits) {
    return leave_out(
        *message, token.line,
        fmt::format("signal {} with {} bits", signal->name, signal->layout.length_bits),
        fmt::format("{} bits for this type", bits));
  }
  signal->layout.type = type == 1 ? RawType::kFloat : RawType::kDouble;
}

/// Reads SG_MUL_VAL_: the values of a multiplexor at which frames have a signal.
void DbcReader::read_multiplexor_values() {
  DbcMessage* message = take_message();
  DbcSignal* signal = take_signal_of(message);
  const std::string multiplexor = take_word("the name of a multiplexor");
  std::vector<DbcValueRange> values{take_range()};
  while (tokens_.peek().is_sign(',')) {
    tokens_.take();
    values.push_back(take_range());
  }
  take_sign(';');
  if (message == nullptr || signal == nullptr) return;
  const auto multiplexors = std::ranges::count_if(message->signals, &DbcSignal::is_multiplexor);
  const bool is_only_one = multiplexors == 1 && message->multiplexor()->name == multiplexor;
  if (!is_only_one) message->nested_multiplexing = true;
  signal->multiplexed_at = std::move(values);
}

/// Takes a range such as "2-5". Some tools write spaces around the sign.
DbcValueRange DbcReader::take_range() {
  constexpr std::string_view kWanted = "a range of values, such as 2-5";
  const DbcToken first = tokens_.peek();
  std::string text;
  while (tokens_.peek().kind == DbcToken::Kind::kWord) text += tokens_.take().text;
  DbcValueRange range;
  const char* const end = text.data() + text.size();
  const auto low = std::from_chars(text.data(), end, range.first);
  if (low.ec != std::errc() || low.ptr == end || *low.ptr != '-') refuse(first, kWanted);
  const auto high = std::from_chars(low.ptr + 1, end, range.last);
  if (high.ec != std::errc() || high.ptr != end || range.last < range.first) refuse(first, kWanted);
  return range;
}

void DbcReader::read_attribute_definition() {
  const bool of_messages = tokens_.peek().is_word("BO_");
  if (tokens_.peek().kind == DbcToken::Kind::kWord) tokens_.take();
  const DbcToken name = tokens_.take();
  if (name.kind != DbcToken::Kind::kText) refuse(name, "the name of an attribute in quotes");
  if (of_messages) message_attributes_.insert(name.text);
  const bool is_enum = tokens_.peek().is_word("ENUM");
  while (!tokens_.peek().is_sign(';')) {
    const DbcToken token = tokens_.take();
    if (token.kind == DbcToken::Kind::kEnd) refuse(token, "';'");
    if (is_enum && token.kind == DbcToken::Kind::kText) enums_[name.text].push_back(token.text);
  }
  tokens_.take();
}

/// Takes the value of an attribute. The value of an ENUM may be a name or its number.
std::string DbcReader::attribute_value(const std::string& name) {
  const DbcToken value = tokens_.take();
  if (value.kind != DbcToken::Kind::kText && value.kind != DbcToken::Kind::kWord) {
    refuse(value, "the value of an attribute");
  }
  const auto values = enums_.find(name);
  if (values == enums_.end() || value.kind == DbcToken::Kind::kText) return value.text;
  const uint64_t number = unsigned_of(value, "the number of an ENUM value");
  if (number >= values->second.size()) {
    refuse(value, fmt::format("0 to {} for attribute {}", values->second.size() - 1, name));
  }
  return values->second[number];
}

void DbcReader::read_attribute_default() {
  const DbcToken name = tokens_.take();
  if (name.kind != DbcToken::Kind::kText) refuse(name, "the name of an attribute in quotes");
  defaults_[name.text] = attribute_value(name.text);
  take_sign(';');
}

void DbcReader::read_attribute() {
  const DbcToken name = tokens_.take();
  if (name.kind != DbcToken::Kind::kText) refuse(name, "the name of an attribute in quotes");
  if (!tokens_.peek().is_word("BO_")) return skip_statement("BA_ (not of a message)");
  tokens_.take();
  DbcMessage* message = take_message();
  const std::string value = attribute_value(name.text);
  if (message != nullptr) message->attributes[name.text] = value;
  take_sign(';');
}

/// Gives the named values of a good message the signs of their signals. Leaves the message out if
/// the signal cannot have the value named SNA, because nothing else shows that the signal is not
/// available. Other names of such values do no harm.
void DbcReader::complete_value_names(DbcMessage& message) const {
  for (DbcSignal& signal : message.signals) {
    if (!is_integer(signal.layout)) continue;
    for (DbcValueName& value : signal.value_names) {
      const auto raw = raw_in(signal.layout, value.raw);
      if (!raw && means_not_available(value.name)) {
        leave_out(message, signal.line,
                  fmt::format("value {} of signal {} with the name {}", value.raw, signal.name,
                              value.name),
                  fmt::format("a value that fits into {} bits", signal.layout.length_bits));
      }
      value.raw = raw.value_or(value.raw);
    }
  }
}

/// Checks what later statements say, and adds the defaults of the attributes.
void DbcReader::complete(DbcMessage& message) const {
  check_multiplexors(message);
  if (message.left_out.empty()) complete_value_names(message);
  if (!message.left_out.empty()) message.signals.clear();
  for (const auto& [name, value] : defaults_) {
    if (message_attributes_.contains(name)) message.attributes.emplace(name, value);
  }
}

}  // namespace bevloc::can
