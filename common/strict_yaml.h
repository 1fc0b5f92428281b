// Reads YAML strictly: every key known, there once, of the right type and within its limits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/result.h"

namespace bevloc {

/// What a value must fulfil beyond its type, and how to say so: `{"more than 0", ...}`.
template <typename T>
struct Wanted {
  std::string description;
  std::function<bool(const T&)> accepts;
};

template <typename T>
Wanted<T> more_than(T limit) {
  return {fmt::format("more than {}", limit), [limit](const T& value) { return value > limit; }};
}

template <typename T>
Wanted<T> at_least(T limit) {
  return {fmt::format("at least {}", limit), [limit](const T& value) { return value >= limit; }};
}

/// Both limits are allowed values.
template <typename T>
Wanted<T> between(T low, T high) {
  return {fmt::format("{} to {}", low, high),
          [low, high](const T& value) { return value >= low && value <= high; }};
}

/// One mapping of a YAML file. Reading goes straight through, without a check after every line:
///
///     auto yaml = YamlMap::read_file(path);
///     if (!yaml) return tl::unexpected(yaml.error());
///     YamlMap can = yaml->require_map("can");
///     config.interface = can.require<std::string>("interface");
///     config.period_s = can.optional<double>("period_s", 0.02, more_than(0.0));
///     if (Status status = yaml->finish(); !status) return tl::unexpected(status.error());
///
/// What goes wrong yields a default value, and finish() reports the first mistake of the file as
/// "file:line: key.of.maps: found X, wanted Y". Reading a key twice is a bug of the caller. Copies
/// refer to the same mapping. Not thread safe. Scalars are YAML's core types; integers may be
/// hexadecimal (0x1F); numbers must be finite; a quoted number is a string.
class YamlMap {
 public:
  /// Fails if the file cannot be read, is not YAML, or is not one mapping.
  static Result<YamlMap> read_file(const std::filesystem::path& path);
  /// The same for text that is there already; `name` stands in the messages for the file.
  static Result<YamlMap> parse(const std::string& text, const std::string& name);

  /// A value that must be there. T: bool, int, int64_t, uint32_t, uint64_t, double, std::string.
  template <typename T>
  T require(std::string_view key, const Wanted<T>& wanted = {});

  /// A value that may be left out.
  template <typename T>
  T optional(std::string_view key, T fallback, const Wanted<T>& wanted = {});

  /// A list of scalars; `count` other than 0 is the length that it must have.
  template <typename T>
  std::vector<T> require_list(std::string_view key, size_t count = 0, const Wanted<T>& wanted = {});

  /// A word that stands for a value: `require_choice<Yaw>("yaw", {{"literal", Yaw::kLiteral},
  /// ...})`.
  template <typename T>
  T require_choice(std::string_view key,
                   std::initializer_list<std::pair<std::string_view, T>> choices) {
    std::vector<std::string_view> words;
    for (const auto& choice : choices) words.push_back(choice.first);
    return (choices.begin() + require_word(key, words))->second;
  }
  template <typename T>
  T optional_choice(std::string_view key, T fallback,
                    std::initializer_list<std::pair<std::string_view, T>> choices) {
    return has(key) ? require_choice(key, choices) : fallback;
  }

  YamlMap require_map(std::string_view key);
  std::optional<YamlMap> optional_map(std::string_view key);
  std::vector<YamlMap> require_map_list(std::string_view key);

  bool has(std::string_view key) const;

  /// Reports a mistake that only the caller can see, at the line of `key` (which may be read
  /// already): reject("rotation_wxyz", "a quaternion of norm 1.2", "norm 1").
  void reject(std::string_view key, std::string_view found, std::string_view wanted);

  /// The first mistake in the whole file, or the first key that nobody asked for; call it once,
  /// after everything was read.
  Status finish() const;

 private:
  struct Document;
  struct Mapping;
  struct Entry;

  YamlMap(std::shared_ptr<Document> document, Mapping* mapping)
      : document_(std::move(document)), mapping_(mapping) {}

  Entry* use(std::string_view key);
  Entry* use_required(std::string_view key, std::string_view wanted);
  size_t require_word(std::string_view key, const std::vector<std::string_view>& words);

  std::shared_ptr<Document> document_;
  Mapping* mapping_;
};

}  // namespace bevloc
