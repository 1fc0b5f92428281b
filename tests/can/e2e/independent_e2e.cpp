#include "tests/can/e2e/independent_e2e.h"

#include <cstdio>
#include <optional>
#include <sstream>

namespace bevloc::test {
namespace {

std::optional<LoggedFrame> parse(const std::string& line) {
  std::istringstream words(line);
  std::string time;
  std::string interface;
  std::string frame;
  if (!(words >> time >> interface >> frame)) return std::nullopt;
  const size_t hash = frame.find('#');
  if (hash != 3 || time.size() < 3) return std::nullopt;
  // A second # means CAN FD, and a digit with flags follows it.
  const size_t data = frame.compare(hash, 2, "##") == 0 ? hash + 3 : hash + 1;
  if (frame.size() < data || (frame.size() - data) % 2 != 0) return std::nullopt;

  LoggedFrame logged;
  logged.time_s = std::stod(time.substr(1, time.size() - 2));
  logged.id = static_cast<uint32_t>(std::stoul(frame.substr(0, hash), nullptr, 16));
  for (size_t i = data; i < frame.size(); i += 2) {
    logged.bytes.push_back(static_cast<uint8_t>(std::stoul(frame.substr(i, 2), nullptr, 16)));
  }
  return logged;
}

bool is_p05(const DbcMessage& message) {
  const auto profile = message.texts.find("E2EProfile");
  return profile != message.texts.end() && profile->second == "P05";
}

bool has_right_crc(const DbcMessage& message, const std::vector<uint8_t>& bytes) {
  const int data_id = message.attributes.at("E2EDataId");
  if (!is_p05(message)) return bytes[0] == expected_p02_crc(bytes, static_cast<uint8_t>(data_id));
  return bytes[0] + 256 * bytes[1] == expected_p05_crc(bytes, static_cast<uint16_t>(data_id));
}

}  // namespace

uint16_t expected_p05_crc(const std::vector<uint8_t>& bytes, uint16_t data_id) {
  std::vector<uint8_t> input(bytes.begin() + 2, bytes.end());
  input.push_back(static_cast<uint8_t>(data_id % 256));
  input.push_back(static_cast<uint8_t>(data_id / 256));
  unsigned crc = 0xFFFF;
  for (const uint8_t byte : input) {
    for (int bit = 7; bit >= 0; --bit) {
      const bool feedback = ((crc >> 15) & 1) != ((byte >> bit) & 1u);
      crc = (crc << 1) & 0xFFFF;
      if (feedback) crc ^= 0x1021;
    }
  }
  return static_cast<uint16_t>(crc);
}

uint8_t expected_p02_crc(const std::vector<uint8_t>& bytes, uint8_t data_id) {
  std::vector<uint8_t> input(bytes.begin() + 1, bytes.end());
  input.push_back(data_id);
  unsigned crc = 0xFF;
  for (const uint8_t byte : input) {
    for (int bit = 7; bit >= 0; --bit) {
      const bool feedback = ((crc >> 7) & 1) != ((byte >> bit) & 1u);
      crc = (crc << 1) & 0xFF;
      if (feedback) crc ^= 0x2F;
    }
  }
  return static_cast<uint8_t>(~crc);
}

E2eLogReport check_candump_log(
    std::istream& log, const Dbc& dbc,
    const std::function<void(const DbcMessage&, const LoggedFrame&)>& on_good) {
  E2eLogReport report;
  std::map<uint32_t, int> last_counter;
  for (std::string line; std::getline(log, line);) {
    const auto frame = parse(line);
    if (!frame) {
      ++report.unreadable_lines;
      continue;
    }
    const auto found = dbc.messages.find(frame->id);
    if (found == dbc.messages.end()) {
      ++report.unknown_frames;
      continue;
    }
    const DbcMessage& message = found->second;
    E2eTally& tally = report.by_message[message.name];
    if (static_cast<int>(frame->bytes.size()) != message.length) {
      ++tally.wrong_length;
      continue;
    }
    if (!has_right_crc(message, frame->bytes)) {
      ++tally.wrong_crc;
      continue;
    }
    const int counters = is_p05(message) ? 256 : 16;
    const int counter = is_p05(message) ? frame->bytes[2] : frame->bytes[1] % 16;
    const auto last = last_counter.find(frame->id);
    const int step =
        last == last_counter.end() ? 1 : (counter - last->second + counters) % counters;
    last_counter[frame->id] = counter;
    if (step == 0) {
      ++tally.repeated;
      continue;
    }
    tally.lost += step - 1;
    ++tally.good;
    if (on_good) on_good(message, *frame);
  }
  return report;
}

}  // namespace bevloc::test
