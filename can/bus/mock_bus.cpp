#include "can/bus/mock_bus.h"

#include <algorithm>
#include <cassert>
#include <condition_variable>
#include <mutex>
#include <vector>

#include "can/bus/bus_counting.h"
#include "can/bus/receive_queue.h"

namespace bevloc::can {
class MockEndpoint;

struct MockWire::State {
  std::mutex mutex;
  std::vector<MockEndpoint*> endpoints;
  bool down = false;
};

class MockEndpoint final : public Bus {
 public:
  MockEndpoint(std::shared_ptr<MockWire::State> wire, size_t queue_capacity)
      : wire_(std::move(wire)), queue_(queue_capacity) {
    const std::lock_guard lock(wire_->mutex);
    wire_->endpoints.push_back(this);
  }

  ~MockEndpoint() override {
    const std::lock_guard lock(wire_->mutex);
    std::erase(wire_->endpoints, this);
  }

  MockEndpoint(const MockEndpoint&) = delete;
  MockEndpoint& operator=(const MockEndpoint&) = delete;

  SendResult send(const Frame& frame, Time now) override {
    assert(frame.id <= kMaxStandardId && is_valid_length(frame.format, frame.length));
    const std::lock_guard lock(wire_->mutex);
    if (wire_->down) {
      ++counters_.send_bus_down;
      return SendResult::kBusDown;
    }
    for (MockEndpoint* endpoint : wire_->endpoints) {
      if (endpoint != this) endpoint->deliver({frame, now});
    }
    ++counters_.sent;
    return SendResult::kSent;
  }

  std::optional<ReceivedFrame> receive() override {
    const std::lock_guard lock(wire_->mutex);
    auto frame = queue_.pop();
    if (frame) ++counters_.received;
    return frame;
  }

  bool wait(Duration timeout) override {
    std::unique_lock lock(wire_->mutex);
    return arrived_.wait_for(lock, timeout, [this] { return !queue_.empty(); });
  }

  BusCounters counters() const override { return counters_.snapshot(); }

  BusCondition condition() const override {
    const std::lock_guard lock(wire_->mutex);
    return {.state = wire_->down ? BusState::kDown : BusState::kActive};
  }

 private:
  void deliver(const ReceivedFrame& frame) {
    if (!queue_.push(frame)) ++counters_.receive_dropped;
    arrived_.notify_one();
  }

  std::shared_ptr<MockWire::State> wire_;
  ReceiveQueue queue_;  // guarded by the wire's mutex
  std::condition_variable arrived_;
  AtomicBusCounters counters_;
};

MockWire::MockWire(size_t queue_capacity)
    : state_(std::make_shared<State>()), queue_capacity_(queue_capacity) {}

std::unique_ptr<Bus> MockWire::connect() {
  return std::make_unique<MockEndpoint>(state_, queue_capacity_);
}

void MockWire::set_down(bool down) {
  const std::lock_guard lock(state_->mutex);
  state_->down = down;
}

}  // namespace bevloc::can
