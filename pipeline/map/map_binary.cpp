#include "pipeline/map/map_binary.h"

#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/crc32.h"
#include "common/files.h"

namespace bevloc {
namespace {

constexpr uint16_t kVersion = 1;
constexpr size_t kVersionOffset = kMapMagic.size();
constexpr size_t kSizeOffset = kVersionOffset + sizeof(uint16_t);
constexpr size_t kHeaderSize = kSizeOffset + sizeof(uint32_t);
constexpr size_t kCrcSize = sizeof(uint32_t);
constexpr int64_t kMaxCoordinate = 100'000'000'000;  // in quanta

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

class Encoder {
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
  void polyline(const std::vector<Eigen::Vector2d>& points) {
    number(points.size());
    for (const Eigen::Vector2d& point : points) {
      for (int axis = 0; axis < 2; ++axis) {
        assert(std::abs(point[axis]) < kMaxCoordinate * kMapQuantumM);
        const int64_t quantised = std::llround(point[axis] / kMapQuantumM);
        step(quantised - last_[axis]);
        last_[axis] = quantised;
      }
    }
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
class Decoder {
 public:
  explicit Decoder(std::string_view bytes) : bytes_(bytes) {}

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

  /// A number below a limit.
  uint64_t number_below(uint64_t limit, std::string_view what) {
    const uint64_t value = number();
    return value < limit ? value : reject(what);
  }

  /// Number of the following items, each of which takes at least `bytes_each` bytes.
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
        const uint64_t zigzag = number();
        const auto step = static_cast<int64_t>(zigzag >> 1U) ^ -static_cast<int64_t>(zigzag & 1U);
        const bool is_near = step >= -2 * kMaxCoordinate && step <= 2 * kMaxCoordinate &&
                             std::abs(last_[axis] + step) <= kMaxCoordinate;
        if (is_near) {
          last_[axis] += step;
        } else {
          reject("a point beyond 100,000 km");
        }
        point[axis] = static_cast<double>(last_[axis]) * kMapQuantumM;
      }
    }
    return points;
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

MapElement decode_element(Decoder& decoder) {
  constexpr auto kClasses = static_cast<uint64_t>(ElementClass::kRoadBoundary) + 1;
  constexpr auto kAppearances = static_cast<uint64_t>(Appearance::kHedge) + 1;
  MapElement element;
  element.element_class =
      static_cast<ElementClass>(decoder.number_below(kClasses, "an unknown class"));
  element.appearance =
      static_cast<Appearance>(decoder.number_below(kAppearances, "an unknown appearance"));
  element.points = decoder.polyline();
  return element;
}

Lane decode_lane(Decoder& decoder, size_t lane_count) {
  constexpr double kMaxSpeedMps = 1000.0;
  Lane lane;
  lane.left = decoder.polyline();
  lane.right = decoder.polyline();
  lane.centerline = decoder.polyline();
  lane.speed_limit_mps = decoder.real(kMaxSpeedMps, "a speed limit beyond 1000 m/s");
  lane.successors.resize(decoder.count(1));
  for (uint32_t& successor : lane.successors) {
    successor =
        static_cast<uint32_t>(decoder.number_below(lane_count, "a successor beyond the last lane"));
  }
  return lane;
}

HdMap decode_body(Decoder& decoder) {
  constexpr size_t kSmallestElement = 3;
  constexpr size_t kSmallestLane = 3 + sizeof(double) + 1;
  HdMap map;
  map.name = decoder.text();
  map.origin.latitude_deg = decoder.real(90.0, "a latitude beyond 90 degrees");
  map.origin.longitude_deg = decoder.real(180.0, "a longitude beyond 180 degrees");
  map.elements.resize(decoder.count(kSmallestElement));
  for (MapElement& element : map.elements) element = decode_element(decoder);
  map.lanes.resize(decoder.count(kSmallestLane));
  for (Lane& lane : map.lanes) lane = decode_lane(decoder, map.lanes.size());
  if (!decoder.at_end()) decoder.reject("more bytes after the last lane");
  return map;
}

/// Checks size, magic, version and CRC, then returns the body.
Result<std::string_view> body_of(std::string_view bytes, const std::string& file) {
  if (bytes.size() < kHeaderSize + kCrcSize) {
    return fail("{}: found {} bytes, wanted a map file of at least {}", file, bytes.size(),
                kHeaderSize + kCrcSize);
  }
  if (!bytes.starts_with(kMapMagic)) {
    return fail("{}: found a different magic number, wanted \"{}\"", file, kMapMagic);
  }
  if (const auto version = fixed_at<uint16_t>(bytes, kVersionOffset); version != kVersion) {
    return fail("{}: found version {} of the format, wanted {}", file, version, kVersion);
  }
  const size_t size = fixed_at<uint32_t>(bytes, kSizeOffset);
  if (bytes.size() != kHeaderSize + size + kCrcSize) {
    return fail("{}: found {} bytes, wanted {} as its header states", file, bytes.size(),
                kHeaderSize + size + kCrcSize);
  }
  const std::string_view checked = bytes.substr(0, kHeaderSize + size);
  const uint32_t found = crc32(checked);
  if (const auto wanted = fixed_at<uint32_t>(bytes, checked.size()); found != wanted) {
    return fail("{}: found CRC-32 {:08x}, wanted {:08x} as the file states", file, found, wanted);
  }
  return checked.substr(kHeaderSize);
}

}  // namespace

std::string encode_map(const HdMap& map) {
  Encoder body;
  body.text(map.name);
  body.real(map.origin.latitude_deg);
  body.real(map.origin.longitude_deg);
  body.number(map.elements.size());
  for (const MapElement& element : map.elements) {
    body.number(static_cast<uint64_t>(element.element_class));
    body.number(static_cast<uint64_t>(element.appearance));
    body.polyline(element.points);
  }
  body.number(map.lanes.size());
  for (const Lane& lane : map.lanes) {
    body.polyline(lane.left);
    body.polyline(lane.right);
    body.polyline(lane.centerline);
    body.real(lane.speed_limit_mps);
    body.number(lane.successors.size());
    for (const uint32_t successor : lane.successors) body.number(successor);
  }
  std::string bytes(kMapMagic);
  append_fixed(bytes, kVersion);
  append_fixed(bytes, static_cast<uint32_t>(body.bytes().size()));
  bytes += body.bytes();
  append_fixed(bytes, crc32(bytes));
  return bytes;
}

Result<HdMap> decode_map(std::string_view bytes, const std::string& file) {
  const Result<std::string_view> body = body_of(bytes, file);
  if (!body) return tl::unexpected(body.error());
  Decoder decoder(*body);
  HdMap map = decode_body(decoder);
  if (decoder.error()) {
    return fail("{}: {}, wanted a valid compact map", file, *decoder.error());
  }
  return map;
}

Result<HdMap> read_map_binary(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return decode_map(*bytes, path.string());
}

Status write_map_binary(const HdMap& map, const std::filesystem::path& path) {
  return write_file(path, encode_map(map));
}

}  // namespace bevloc
