#include "tests/can/independent_e2e.h"

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
  if (hash != 3 || time.size() < 3 || frame.size() % 2 != 0) return std::nullopt;

  LoggedFrame logged;
  logged.time_s = std::stod(time.substr(1, time.size() - 2));
  logged.id = static_cast<uint32_t>(std::stoul(frame.substr(0, hash), nullptr, 16));
  for (size_t i = hash + 1; i < frame.size(); i += 2) {
    logged.bytes.push_back(static_cast<uint8_t>(std::stoul(frame.substr(i, 2), nullptr, 16)));
  }
  return logged;
}

}  // namespace

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
    const auto data_id = static_cast<uint8_t>(message.attributes.at("E2EDataId"));
    if (frame->bytes[0] != expected_p02_crc(frame->bytes, data_id)) {
      ++tally.wrong_crc;
      continue;
    }
    const int counter = frame->bytes[1] % 16;
    const auto last = last_counter.find(frame->id);
    const int step = last == last_counter.end() ? 1 : (counter - last->second + 16) % 16;
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
