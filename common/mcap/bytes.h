// Numbers and texts as bytes of an MCAP record: little-endian, texts with four bytes of length.
#pragma once

#include <concepts>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace bevloc::mcap {

/// Appends numbers and texts to a string.
class ByteWriter {
 public:
  /// `bytes` must outlive this.
  explicit ByteWriter(std::string& bytes) : bytes_(bytes) {}

  template <std::unsigned_integral T>
  ByteWriter& number(T value) {
    for (size_t i = 0; i < sizeof(T); ++i) {
      bytes_.push_back(static_cast<char>(value >> (8 * i)));
    }
    return *this;
  }
  ByteWriter& raw(std::string_view bytes) {
    bytes_.append(bytes);
    return *this;
  }
  ByteWriter& text(std::string_view text) {
    return number(static_cast<uint32_t>(text.size())).raw(text);
  }
  ByteWriter& texts(const std::map<std::string, std::string>& values) {
    std::string pairs;
    ByteWriter writer(pairs);
    for (const auto& [key, value] : values) writer.text(key).text(value);
    return text(pairs);
  }

 private:
  std::string& bytes_;
};

/// Takes values from the front of a span of bytes. After the first value that does not fit, ok() is
/// false and every value is zero or empty.
class ByteReader {
 public:
  /// `bytes` must outlive what raw() and text() return.
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <std::unsigned_integral T>
  T number() {
    const std::string_view taken = raw(sizeof(T));
    T value = 0;
    for (size_t i = 0; i < taken.size(); ++i) {
      value = static_cast<T>(
          value | static_cast<T>(static_cast<T>(static_cast<uint8_t>(taken[i])) << (8 * i)));
    }
    return value;
  }
  std::string_view raw(uint64_t count) {
    if (!ok_ || count > bytes_.size()) {
      ok_ = false;
      return {};
    }
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  std::string_view text() { return raw(number<uint32_t>()); }
  std::map<std::string, std::string> texts() {
    std::map<std::string, std::string> values;
    ByteReader pairs(text());
    while (pairs.ok() && !pairs.rest().empty()) {
      const std::string_view key = pairs.text();
      values.emplace(key, pairs.text());
    }
    ok_ = ok_ && pairs.ok();
    return values;
  }
  std::string_view rest() const { return bytes_; }
  bool ok() const { return ok_; }

 private:
  std::string_view bytes_;
  bool ok_ = true;
};

}  // namespace bevloc::mcap
