#include "can/bus/candump.h"

#include <algorithm>
#include <cassert>
#include <fstream>
#include <istream>
#include <iterator>
#include <optional>
#include <span>

#include "common/number_text.h"

namespace bevloc::can {
namespace {

using std::chrono::nanoseconds;

constexpr uint32_t kErrorFlag = 0x20000000;
constexpr uint32_t kMaxExtendedId = 0x1FFFFFFF;

/// Reads the whole text as an unsigned number. Returns nothing if it is not one.
template <typename T>
std::optional<T> number(std::string_view text, int base) {
  if (text.starts_with('-')) return std::nullopt;
  return parse_number<T>(text, base);
}

bool is_hex(std::string_view text) {
  return std::ranges::all_of(text, [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
  });
}

/// Reads "1436509052.249713", with 6 or 9 digits after the point.
std::optional<nanoseconds> parse_time(std::string_view text) {
  constexpr int64_t kMaxSeconds = INT64_MAX / 1'000'000'000 - 1;
  const size_t point = text.find('.');
  if (point == std::string_view::npos) return std::nullopt;
  const std::string_view fraction = text.substr(point + 1);
  const auto seconds = number<int64_t>(text.substr(0, point), 10);
  const auto parts = number<int64_t>(fraction, 10);
  if (!seconds || !parts || *seconds > kMaxSeconds) return std::nullopt;
  if (fraction.size() != 6 && fraction.size() != 9) return std::nullopt;
  return nanoseconds(*seconds * 1'000'000'000 + *parts * (fraction.size() == 6 ? 1000 : 1));
}

struct ParsedFrame {
  CandumpKind kind = CandumpKind::kData;
  Frame frame;
  ErrorFrame error;
};

/// Writes the bytes of the hexadecimal digits into `data`, which must be large enough.
void parse_bytes(std::string_view digits, std::span<uint8_t> data) {
  for (size_t i = 0; i < digits.size() / 2; ++i) {
    data[i] = *number<uint8_t>(digits.substr(2 * i, 2), 16);
  }
}

/// Reads a data frame whose data is given as hexadecimal digits.
std::optional<ParsedFrame> parse_data(FrameFormat format, uint32_t id, bool extended,
                                      std::string_view digits) {
  if (id > kMaxExtendedId || !is_hex(digits) || digits.size() % 2 != 0 ||
      !is_valid_length(format, digits.size() / 2)) {
    return std::nullopt;
  }
  if (extended) return ParsedFrame{CandumpKind::kExtended, {}, {}};
  ParsedFrame parsed;
  parsed.frame = {
      .id = id, .length = static_cast<uint8_t>(digits.size() / 2), .data = {}, .format = format};
  parse_bytes(digits, parsed.frame.data);
  return parsed;
}

std::optional<ParsedFrame> parse_error(uint32_t id, std::string_view digits) {
  const bool valid = is_hex(digits) && digits.size() == 2 * kMaxClassicLength &&
                     (id & ~(kErrorFlag | kMaxExtendedId)) == 0;
  if (!valid) return std::nullopt;
  ParsedFrame parsed{CandumpKind::kError, {}, {.classes = id & kMaxExtendedId, .data = {}}};
  parse_bytes(digits, parsed.error.data);
  return parsed;
}

/// Whether the text is a raw length code: "_" and a digit from 9 to F. candump appends it to eight
/// bytes of data if the length code of the frame is larger than 8.
bool is_length_code(std::string_view text) {
  return text.size() == 2 && text[0] == '_' && is_hex(text.substr(1)) && text[1] >= '9';
}

/// Reads what follows the R of a remote frame: nothing, or a length digit and perhaps its code.
std::optional<ParsedFrame> parse_remote(uint32_t id, std::string_view length) {
  const bool is_digit = length.size() == 1 && length[0] >= '0' && length[0] <= '8';
  const bool has_code = length.starts_with('8') && is_length_code(length.substr(1));
  const bool valid = length.empty() || is_digit || has_code;
  if (!valid || id > kMaxExtendedId) return std::nullopt;
  return ParsedFrame{CandumpKind::kRemote, {}, {}};
}

/// Removes the raw length code.
std::string_view without_length_code(std::string_view data) {
  constexpr size_t kFullDigits = 2 * kMaxClassicLength;
  const bool has_code = data.size() > kFullDigits && is_length_code(data.substr(kFullDigits));
  return has_code ? data.substr(0, kFullDigits) : data;
}

/// Reads "044#2A366C2BBA", "123##1AABB", "7DF#R" or "20000004#0000000000000000".
std::optional<ParsedFrame> parse_frame(std::string_view text) {
  const size_t hash = text.find('#');
  if (hash != 3 && hash != 8) return std::nullopt;
  const bool extended = hash == 8;
  const auto id = number<uint32_t>(text.substr(0, hash), 16);
  if (!id || (!extended && *id > kMaxStandardId)) return std::nullopt;

  const std::string_view data = text.substr(hash + 1);
  if (data.starts_with('#')) {
    const std::string_view flags = data.substr(1, 1);
    if (flags.empty() || !is_hex(flags)) return std::nullopt;
    return parse_data(FrameFormat::kFd, *id, extended, data.substr(2));
  }
  if (data.starts_with('R')) return parse_remote(*id, data.substr(1));
  if (extended && (*id & kErrorFlag) != 0) return parse_error(*id, without_length_code(data));
  return parse_data(FrameFormat::kClassic, *id, extended, without_length_code(data));
}

/// Returns "(1436509052.249713) can0 ".
std::string line_beginning(nanoseconds time, std::string_view interface, CandumpDigits digits) {
  assert(time >= nanoseconds::zero());
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  const int64_t fraction = (time - seconds).count();
  const bool micro = digits == CandumpDigits::kMicroseconds;
  return fmt::format("({:010}.{:0{}}) {} ", seconds.count(), micro ? fraction / 1000 : fraction,
                     static_cast<int>(digits), interface);
}

void append_bytes(std::string& line, std::span<const uint8_t> bytes) {
  for (const uint8_t byte : bytes) fmt::format_to(std::back_inserter(line), "{:02X}", byte);
}

}  // namespace

std::string candump_line(nanoseconds time, std::string_view interface, const Frame& frame,
                         CandumpDigits digits) {
  std::string line = line_beginning(time, interface, digits);
  const bool fd = frame.format == FrameFormat::kFd;
  fmt::format_to(std::back_inserter(line), "{:03X}{}", frame.id, fd ? "##1" : "#");
  append_bytes(line, frame.payload());
  return line;
}

std::string candump_line(nanoseconds time, std::string_view interface, const ErrorFrame& error,
                         CandumpDigits digits) {
  std::string line = line_beginning(time, interface, digits);
  fmt::format_to(std::back_inserter(line), "{:08X}#", kErrorFlag | error.classes);
  append_bytes(line, error.data);
  return line;
}

Result<CandumpEntry> parse_candump_line(std::string_view line, std::string_view place) {
  const auto refuse = [&] {
    return fail(
        "{}: found '{}', wanted '(seconds.micros) interface id#data' as candump -l writes it",
        place, line.substr(0, 80));
  };
  const size_t time_end = line.find(") ");
  if (!line.starts_with('(') || time_end == std::string_view::npos) return refuse();
  std::string_view rest = line.substr(time_end + 2);
  rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
  const size_t interface_end = rest.find(' ');
  if (interface_end == std::string_view::npos) return refuse();
  std::string_view frame_text = rest.substr(interface_end + 1);
  // Newer versions of candump append the direction (R or T).
  if (frame_text.ends_with(" R") || frame_text.ends_with(" T")) frame_text.remove_suffix(2);

  const auto time = parse_time(line.substr(1, time_end - 1));
  const auto parsed = parse_frame(frame_text);
  if (!time || !parsed) return refuse();
  return CandumpEntry{*time, std::string(rest.substr(0, interface_end)), parsed->kind,
                      parsed->frame, parsed->error};
}

Result<std::optional<CandumpEntry>> CandumpReader::next() {
  constexpr std::string_view kDropped = "DROPCOUNT: ";
  std::string line;
  while (std::getline(log_, line)) {
    ++line_number_;
    if (line.ends_with('\r')) line.pop_back();
    if (line.empty() || line.starts_with(kDropped)) continue;
    auto entry = parse_candump_line(line, fmt::format("{}:{}", name_, line_number_));
    if (!entry) return tl::unexpected(entry.error());
    return std::optional(std::move(*entry));
  }
  // A folder opens, but cannot be read.
  if (log_.bad()) return fail("{}: found no readable file, wanted a candump log", name_);
  return std::nullopt;
}

Result<std::vector<CandumpEntry>> read_candump(std::istream& log, std::string_view name) {
  CandumpReader reader(log, std::string(name));
  std::vector<CandumpEntry> entries;
  for (;;) {
    auto entry = reader.next();
    if (!entry) return tl::unexpected(entry.error());
    if (!*entry) return entries;
    entries.push_back(std::move(**entry));
  }
}

Result<std::vector<CandumpEntry>> read_candump_file(const std::string& path) {
  std::ifstream log(path);
  if (!log) return fail("{}: found no readable file, wanted a candump log", path);
  return read_candump(log, path);
}

}  // namespace bevloc::can
