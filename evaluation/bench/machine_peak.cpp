#include "evaluation/bench/machine_peak.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "evaluation/bench/int8_peak.h"
#include "evaluation/bench/timing.h"

namespace bevloc::bench {
namespace {

constexpr int kRepeats = 9;

/// The median time of several runs. The times of the stages are medians too.
double median_s(const std::function<void()>& run) {
  return time_of(run, kRepeats).p50_ms / kMs_per_s;
}

/// Bytes read plus bytes written, per second.
double copy_bytes_per_s(int threads) {
  constexpr size_t kBytes = size_t{64} << 20U;
  const auto from = std::make_unique<std::byte[]>(kBytes);
  const auto to = std::make_unique<std::byte[]>(kBytes);
  const size_t share = kBytes / static_cast<size_t>(threads);
  const double seconds = median_s([&] {
    std::vector<std::jthread> others;
    const auto copy = [&](size_t part) {
      std::memcpy(to.get() + part * share, from.get() + part * share, share);
    };
    for (int part = 1; part < threads; ++part) others.emplace_back(copy, part);
    copy(0);
  });
  return 2.0 * static_cast<double>(share * static_cast<size_t>(threads)) / seconds;
}

}  // namespace

MachinePeak measure_machine(int threads) {
  const Int8Peak int8 = measure_int8_peak(threads, median_s);
  return {int8.convolution_macs_per_s, int8.matmul_macs_per_s, copy_bytes_per_s(threads)};
}

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(": ") + 2);
  }
  std::ifstream board("/proc/device-tree/model");
  if (std::string name; std::getline(board, name, '\0') && !name.empty()) return name;
  return "unknown";
}

}  // namespace bevloc::bench
