#include "can/dbc/dbc.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "can/dbc/dbc_reader.h"
#include "common/files.h"

namespace bevloc::can {
namespace {

bool is_utf8(std::string_view text) {
  for (size_t i = 0; i < text.size();) {
    const auto byte = static_cast<uint8_t>(text[i]);
    const size_t length = byte < 0x80             ? 1
                          : (byte & 0xE0) == 0xC0 ? 2
                          : (byte & 0xF0) == 0xE0 ? 3
                          : (byte & 0xF8) == 0xF0 ? 4
                                                  : 0;
    if (length == 0 || i + length > text.size()) return false;
    for (size_t j = 1; j < length; ++j) {
      if ((static_cast<uint8_t>(text[i + j]) & 0xC0) != 0x80) return false;
    }
    i += length;
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

const DbcValueName* DbcSignal::find_value(std::string_view value_name) const {
  const auto found = std::ranges::find(value_names, value_name, &DbcValueName::name);
  return found == value_names.end() ? nullptr : &*found;
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
  double value = 0.0;
  const std::string& text = found->second;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool good = error == std::errc() && end == text.data() + text.size() && value > 0.0;
  return good ? std::optional(value) : std::nullopt;
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
  const Result<std::string> text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  return parse_dbc(*text, path.string());
}

}  // namespace bevloc::can
