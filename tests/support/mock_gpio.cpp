#include "tests/support/mock_gpio.h"

#include <algorithm>
#include <cassert>

namespace bevloc::test {
namespace {

/// The number of unfetched edges that the kernel keeps.
constexpr size_t kEdgeCapacity = 16;

}  // namespace

class MockGpio::Output final : public drivers::OutputLine {
 public:
  Output(MockGpio& gpio, unsigned line) : gpio_(gpio), line_(line) {}
  ~Output() override { gpio_.release(line_); }

  Status set(bool active) override {
    const std::lock_guard lock(gpio_.mutex_);
    if (gpio_.unplugged_) return fail("{}: the GPIO chip was removed", kChip);
    gpio_.put(line_, active != gpio_.wires_[line_].active_low);
    return {};
  }

 private:
  MockGpio& gpio_;
  unsigned line_;
};

class MockGpio::Input final : public drivers::InputLine {
 public:
  Input(MockGpio& gpio, unsigned line) : gpio_(gpio), line_(line) {}
  ~Input() override { gpio_.release(line_); }

  Result<bool> active() override {
    const std::lock_guard lock(gpio_.mutex_);
    if (gpio_.unplugged_) return fail("{}: the GPIO chip was removed", kChip);
    const Wire& wire = gpio_.wires_[line_];
    return wire.high != wire.active_low;
  }

  Result<std::optional<drivers::LineEdge>> next_edge(Duration timeout) override {
    std::unique_lock lock(gpio_.mutex_);
    std::deque<drivers::LineEdge>& edges = gpio_.wires_[line_].edges;
    gpio_.edge_arrived_.wait_for(lock, timeout, [&] { return !edges.empty() || gpio_.unplugged_; });
    if (gpio_.unplugged_) return fail("{}: the GPIO chip was removed", kChip);
    if (edges.empty()) return std::nullopt;
    const drivers::LineEdge edge = edges.front();
    edges.pop_front();
    return edge;
  }

 private:
  MockGpio& gpio_;
  unsigned line_;
};

MockGpio::MockGpio(const std::vector<std::string>& line_names, const drivers::Clock& clock)
    : clock_(clock), wires_(line_names.size()) {
  for (const std::string& name : line_names) chip_.lines.push_back({name, ""});
}

Result<std::unique_ptr<drivers::OutputLine>> MockGpio::open_output(
    const drivers::LineAddress& address, bool active) {
  const std::lock_guard lock(mutex_);
  const auto line = claim(address);
  if (!line) return tl::unexpected(line.error());
  put(*line, active != address.active_low);
  return std::make_unique<Output>(*this, *line);
}

Result<std::unique_ptr<drivers::InputLine>> MockGpio::open_input(
    const drivers::LineAddress& address) {
  const std::lock_guard lock(mutex_);
  const auto line = claim(address);
  if (!line) return tl::unexpected(line.error());
  wires_[*line].is_input = true;
  return std::make_unique<Input>(*this, *line);
}

bool MockGpio::high(const std::string& line) const {
  const std::lock_guard lock(mutex_);
  return wires_[index_of(line)].high;
}

std::vector<MockGpio::Change> MockGpio::changes(const std::string& line) const {
  const std::lock_guard lock(mutex_);
  return wires_[index_of(line)].changes;
}

void MockGpio::drive(const std::string& line, bool high) {
  const std::lock_guard lock(mutex_);
  put(index_of(line), high);
}

void MockGpio::unplug() {
  const std::lock_guard lock(mutex_);
  unplugged_ = true;
  edge_arrived_.notify_all();
}

/// The caller of claim(), put() and index_of() holds the lock.
Result<unsigned> MockGpio::claim(const drivers::LineAddress& address) {
  const auto place = drivers::find_free_line(
      unplugged_ ? std::vector<drivers::GpioChipInfo>() : std::vector{chip_}, address);
  if (!place) return tl::unexpected(place.error());
  chip_.lines[place->line].consumer = drivers::kGpioConsumer;
  wires_[place->line].active_low = address.active_low;
  return place->line;
}

void MockGpio::put(unsigned line, bool high) {
  Wire& wire = wires_[line];
  if (wire.high == high) return;
  wire.high = high;
  wire.changes.push_back({clock_.now(), high});
  if (!wire.is_input || wire.edges.size() == kEdgeCapacity) return;
  wire.edges.push_back({clock_.now(), high != wire.active_low});
  edge_arrived_.notify_all();
}

unsigned MockGpio::index_of(const std::string& line) const {
  const auto found = std::ranges::find(chip_.lines, line, &drivers::GpioLineInfo::name);
  assert(found != chip_.lines.end());
  return static_cast<unsigned>(found - chip_.lines.begin());
}

void MockGpio::release(unsigned line) {
  const std::lock_guard lock(mutex_);
  chip_.lines[line].consumer.clear();
  wires_[line].is_input = false;
  wires_[line].edges.clear();
}

}  // namespace bevloc::test
