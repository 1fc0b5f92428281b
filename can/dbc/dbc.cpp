#include "can/dbc/dbc.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "can/dbc/dbc_reader.h"
#include "common/files.h"
#include "common/number_text.h"

namespace bevloc::can {
namespace {

/// Returns the number of bytes of the first character of the text, or 0 if it is not UTF-8 (RFC
/// 3629).
size_t utf8_length(std::string_view text) {
  constexpr uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const auto first = static_cast<uint8_t>(text[0]);
  const size_t length = first < 0x80             ? 1
                        : (first & 0xE0) == 0xC0 ? 2
                        : (first & 0xF0) == 0xE0 ? 3
                        : (first & 0xF8) == 0xF0 ? 4
                                                 : 0;
  if (length <= 1) return length;
  if (length > text.size()) return 0;
  uint32_t code = first & (0x7FU >> length);
  for (const char c : text.substr(1, length - 1)) {
    const auto byte = static_cast<uint8_t>(c);
    if ((byte & 0xC0) != 0x80) return 0;
    code = code << 6 | (byte & 0x3FU);
  }
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  return code < kLeast[length] || code > 0x10FFFF || is_surrogate ? 0 : length;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string utf8_from_latin1(std::string_view text) {
  std::string utf8;
  for (const char c : text) {
    const auto byte = static_cast<uint8_t>(c);
    if (byte < 0x80) {
      utf8 += c;
    } else {
      utf8 += static_cast<char>(0xC0 | byte >> 6);
      utf8 += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return utf8;
}

}  // namespace

bool means_not_available(std::string_view value_name) {
  return value_name == "SNA" || value_name == "sna";
}

std::vector<int64_t> DbcSignal::values_named(std::string_view value_name) const {
  std::vector<int64_t> values;
  for (const DbcValueName& value : value_names) {
    if (value.name == value_name) values.push_back(value.raw);
  }
  return values;
}

bool DbcSignal::is_present_at(uint64_t multiplexor) const {
  return multiplexed_at.empty() ||
         std::ranges::any_of(multiplexed_at, [multiplexor](const DbcValueRange& range) {
           return range.first <= multiplexor && multiplexor <= range.last;
         });
}

AvailableValues DbcSignal::available_values() const {
  AvailableValues available;
  if (has_range()) {
    const double half_step = is_integer(layout) ? 0.5 * std::abs(layout.scale) : 0.0;
    available.min = min - half_step;
    available.max = max + half_step;
  }
  for (const DbcValueName& value : value_names) {
    if (means_not_available(value.name)) available.not_available.push_back(value.raw);
  }
  return available;
}

const DbcSignal* DbcMessage::find(std::string_view signal_name) const {
  const auto found = std::ranges::find(signals, signal_name, &DbcSignal::name);
  return found == signals.end() ? nullptr : &*found;
}

const DbcSignal* DbcMessage::multiplexor() const {
  const auto found = std::ranges::find_if(signals, &DbcSignal::is_multiplexor);
  return found == signals.end() ? nullptr : &*found;
}

std::optional<double> DbcMessage::cycle_ms() const {
  const auto found = attributes.find("GenMsgCycleTime");
  if (found == attributes.end()) return std::nullopt;
  const auto value = parse_number<double>(found->second);
  return value > 0.0 ? value : std::nullopt;
}

const DbcMessage* Dbc::find(std::string_view message_name) const {
  const auto found = std::ranges::find(messages, message_name, &DbcMessage::name);
  return found == messages.end() ? nullptr : &*found;
}

const DbcMessage* Dbc::find(uint32_t id, bool is_extended) const {
  const auto found = std::ranges::find_if(messages, [&](const DbcMessage& message) {
    return message.id == id && message.is_extended == is_extended;
  });
  return found == messages.end() ? nullptr : &*found;
}

Result<Dbc> parse_dbc(std::string_view text, const std::string& name) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  const std::string converted = is_utf8(text) ? std::string(text) : utf8_from_latin1(text);
  try {
    Dbc dbc = DbcReader(converted, name).read();
    if (!dbc.messages.empty()) return dbc;
  } catch (DbcMistake& mistake) {
    return tl::unexpected(std::move(mistake.error));
  }
  return fail("{}: found no message, wanted a DBC file with BO_ lines", name);
}

Result<Dbc> read_dbc_file(const std::filesystem::path& path) {
  return parse_file(path, parse_dbc);
}

}  // namespace bevloc::can
