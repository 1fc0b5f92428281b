// The numbers of compact map files: varints, zigzag-coded differences and little-endian values.
#pragma once

#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>

#include "pipeline/map/map_binary.h"

namespace bevloc {

/// The largest coordinate, in quanta.
inline constexpr int64_t kMaxCoordinate = 100'000'000'000;

template <typename T>
void append_fixed(std::string& bytes, T value) {
  for (size_t i = 0; i < sizeof(T); ++i) {
    bytes.push_back(static_cast<char>((value >> (8 * i)) & 0xFF));
  }
}

template <typename T>
T fixed_at(std::string_view bytes, size_t offset) {
  T value = 0;
  for (size_t i = 0; i < sizeof(T); ++i) {
    value =
        static_cast<T>(value | static_cast<T>(static_cast<uint8_t>(bytes[offset + i])) << (8 * i));
  }
  return value;
}

/// Appends values to a string of bytes.
class CompactEncoder {
 public:
  void number(uint64_t value) {
    while (value >= 0x80) {
      bytes_.push_back(static_cast<char>((value & 0x7F) | 0x80));
      value >>= 7U;
    }
    bytes_.push_back(static_cast<char>(value));
  }
  void real(double value) { append_fixed(bytes_, std::bit_cast<uint64_t>(value)); }
  void text(std::string_view value) {
    number(value.size());
    bytes_ += value;
  }
  void byte(uint8_t value) { bytes_.push_back(static_cast<char>(value)); }
  /// Each point is stored as a difference from the one before. The next one counts from (x, y).
  void start_from(int64_t x, int64_t y) {
    last_[0] = x;
    last_[1] = y;
  }
  void polyline(const std::vector<Eigen::Vector2d>& points) {
    number(points.size());
    for (const Eigen::Vector2d& point : points) {
      for (int axis = 0; axis < 2; ++axis) {
        assert(std::abs(point[axis]) < kMaxCoordinate * kMapQuantumM);
        coordinate(axis, std::llround(point[axis] / kMapQuantumM));
      }
    }
  }
  void coordinate(int axis, int64_t quanta) {
    step(quanta - last_[axis]);
    last_[axis] = quanta;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  void step(int64_t value) {
    number((static_cast<uint64_t>(value) << 1U) ^ static_cast<uint64_t>(value >> 63));
  }

  std::string bytes_;
  int64_t last_[2] = {0, 0};
};

/// Reads a body. After the first error every value reads as zero or empty.
class CompactDecoder {
 public:
  explicit CompactDecoder(std::string_view bytes) : bytes_(bytes) {}

  uint64_t number() {
    uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      if (at_ == bytes_.size()) return reject("the end of the body within a number");
      const auto byte = static_cast<uint8_t>(bytes_[at_++]);
      value |= static_cast<uint64_t>(byte & 0x7F) << shift;
      if (byte < 0x80) return value;
    }
    return reject("a number of more than 64 bits");
  }

  /// Reads a number below a limit.
  uint64_t number_below(uint64_t limit, std::string_view what) {
    const uint64_t value = number();
    return value < limit ? value : reject(what);
  }

  /// Reads the number of the following items, each of which takes at least `bytes_each` bytes.
  size_t count(size_t bytes_each) {
    const uint64_t value = number();
    const bool fits = value <= (bytes_.size() - at_) / bytes_each;
    return static_cast<size_t>(fits ? value : reject("a count that exceeds the body"));
  }

  double real(double limit, std::string_view what) {
    if (bytes_.size() - at_ < sizeof(uint64_t)) {
      reject("the end of the body within a number");
      return 0.0;
    }
    const auto value = std::bit_cast<double>(fixed_at<uint64_t>(bytes_, at_));
    at_ += sizeof(uint64_t);
    if (std::abs(value) <= limit) return value;
    reject(what);
    return 0.0;
  }

  std::string text() {
    const size_t length = count(1);
    at_ += length;
    return std::string(bytes_.substr(at_ - length, length));
  }

  std::vector<Eigen::Vector2d> polyline() {
    std::vector<Eigen::Vector2d> points(count(2));
    for (Eigen::Vector2d& point : points) {
      for (int axis = 0; axis < 2; ++axis) {
        point[axis] = static_cast<double>(coordinate(axis)) * kMapQuantumM;
      }
    }
    return points;
  }

  /// The next point counts from (x, y), as in CompactEncoder::start_from().
  void start_from(int64_t x, int64_t y) {
    last_[0] = x;
    last_[1] = y;
  }

  /// Reads the next coordinate, in quanta.
  int64_t coordinate(int axis) {
    const uint64_t zigzag = number();
    const auto step = static_cast<int64_t>(zigzag >> 1U) ^ -static_cast<int64_t>(zigzag & 1U);
    const bool is_near = step >= -2 * kMaxCoordinate && step <= 2 * kMaxCoordinate &&
                         std::abs(last_[axis] + step) <= kMaxCoordinate;
    if (is_near) {
      last_[axis] += step;
    } else {
      reject("a point beyond 100,000 km");
    }
    return last_[axis];
  }

  uint8_t byte() {
    if (at_ == bytes_.size())
      return static_cast<uint8_t>(reject("the end of the body within a piece"));
    return static_cast<uint8_t>(bytes_[at_++]);
  }

  bool at_end() const { return at_ == bytes_.size(); }
  uint64_t reject(std::string_view found) {
    if (!error_) error_ = fmt::format("byte {} of the body: found {}", at_, found);
    at_ = bytes_.size();
    return 0;
  }
  const std::optional<std::string>& error() const { return error_; }

 private:
  std::string_view bytes_;
  size_t at_ = 0;
  int64_t last_[2] = {0, 0};
  std::optional<std::string> error_;
};

/// Write and read the lanes, which are alike in both versions of the format (map_binary.cpp).
void encode_lanes(const std::vector<Lane>& lanes, CompactEncoder& body);
std::vector<Lane> decode_lanes(CompactDecoder& decoder);

}  // namespace bevloc
