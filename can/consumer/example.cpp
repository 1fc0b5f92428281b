// The example of example.c in C++, for candump logs: consumer_cpp can.log
#include <array>
#include <cstdio>
#include <fstream>
#include <string>

#include "bevloc.hpp"
#include "candump_line.h"

namespace {

using std::chrono::microseconds;

constexpr bevloc::consumer::AlertLimits kFreeway = {0.57, 1.40, 1.50, 5};

/// Prints each change of the answer, and a pose a second.
class Printer {
 public:
  void take(const candump_line& frame) {
    const microseconds now(frame.time_us);
    if (!first_) first_ = now;
    if (answer_) look(now);
    receiver_.receive(frame.id, {frame.data, frame.length}, now);
    look(now);
  }

  void print_counters() const {
    const auto& counters = receiver_.counters();
    std::printf(
        "frames: %u ok, %u lost, %u repeated, %u wrong CRC, %u wrong length; %u incomplete poses\n",
        counters.ok, counters.lost, counters.repeated, counters.wrong_crc, counters.wrong_length,
        counters.incomplete);
  }

 private:
  void look(microseconds now) {
    const auto answer = receiver_.answer(now);
    if (answer == answer_ && (answer != BEVLOC_USABLE || now < next_)) return;
    const double time_s = std::chrono::duration<double>(now - *first_).count();
    std::printf("%.3f %s", time_s, std::string(bevloc::consumer::name_of(answer)).c_str());
    if (const auto pose = receiver_.usable_pose(now)) {
      std::printf(" east %.2f north %.2f heading %.2f lateral %.2f longitudinal %.2f yaw %.2f",
                  pose->east_m, pose->north_m, pose->heading_deg, pose->lateral_m,
                  pose->longitudinal_m, pose->yaw_deg);
    }
    std::printf("\n");
    answer_ = answer;
    next_ = now + std::chrono::seconds(1);
  }

  bevloc::consumer::Receiver receiver_{kFreeway};
  std::optional<microseconds> first_;
  std::optional<bevloc::consumer::Answer> answer_;
  microseconds next_{};
};

/// Returns 0, or prints why the log cannot be read and returns 1.
int read_log(const char* path) {
  std::ifstream log(path);
  // A folder opens, but has no first character.
  if (log) log.peek();
  if (!log.is_open() || log.bad()) {
    std::fprintf(stderr, "%s: found no readable file, wanted a candump log\n", path);
    return 1;
  }
  log.clear();
  Printer printer;
  candump_line frame{};
  candump_interface first{};
  int number = 0;
  for (std::string line; std::getline(log, line);) {
    ++number;
    line += '\n';
    const candump_kind kind = candump_parse(line.c_str(), &frame);
    if (kind == CANDUMP_DATA && candump_is_of_first(&first, &frame, path, number)) {
      printer.take(frame);
    }
    if (kind != CANDUMP_BAD) continue;
    std::fflush(stdout);
    std::fprintf(stderr, "%s:%d: found something else, wanted %s\n", path, number, CANDUMP_WANTED);
    return 1;
  }
  printer.print_counters();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2) return read_log(argv[1]);
  std::fprintf(stderr, "usage: consumer_cpp FILE, a candump log\n");
  return 2;
}
