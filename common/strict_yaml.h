// Reads YAML strictly: every key must be known, occur once, have the right type and be in range.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/result.h"
#include "common/yaml_recording.h"

namespace bevloc {

/// A condition on a value beyond its type, and its description: `{"more than 0", ...}`.
template <typename T>
struct Wanted {
  std::string description;
  std::function<bool(const T&)> accepts;
  YamlLimits limits{};  ///< the same condition for the schema, as far as a schema can express it
};

template <typename T>
Wanted<T> more_than(T limit) {
  return {fmt::format("more than {}", limit),
          [limit](const T& value) { return value > limit; },
          {.low = static_cast<double>(limit), .excludes_low = true}};
}

template <typename T>
Wanted<T> at_least(T limit) {
  return {fmt::format("at least {}", limit),
          [limit](const T& value) { return value >= limit; },
          {.low = static_cast<double>(limit)}};
}

/// Accepts the limits themselves, too.
template <typename T>
Wanted<T> between(T low, T high) {
  return {fmt::format("{} to {}", low, high),
          [low, high](const T& value) { return value >= low && value <= high; },
          {.low = static_cast<double>(low), .high = static_cast<double>(high)}};
}

/// Accepts a text of 1 to `longest` bytes.
Wanted<std::string> not_empty(std::string description,
                              size_t longest = std::numeric_limits<size_t>::max());

/// Accepts one of these words.
Wanted<std::string> one_of(std::vector<std::string> words);

/// One mapping of a YAML file. Callers read all keys and check for errors once, at the end:
///
///     auto yaml = YamlMap::read_file(path);
///     if (!yaml) return tl::unexpected(yaml.error());
///     YamlMap can = yaml->require_map("can");
///     config.interface = can.require<std::string>("interface");
///     config.period_s = can.optional<double>("period_s", 0.02, more_than(0.0));
///     if (Status status = yaml->finish(); !status) return tl::unexpected(status.error());
///
/// A key that cannot be read yields a default value, and finish() reports the first mistake of the
/// file as "file:line: key.of.maps: found X, wanted Y". Reading a key twice is a programming error.
/// Copies refer to the same mapping. One thread. Scalars have the types of YAML's core schema:
/// integers may be hexadecimal (0x1F), numbers must be finite, and a quoted number is a string.
class YamlMap {
 public:
  /// Fails if the file cannot be read, is not YAML, or is not one mapping.
  static Result<YamlMap> read_file(const std::filesystem::path& path);
  /// Like read_file(), but for text in memory. Messages show `name` as the file.
  static Result<YamlMap> parse(const std::string& text, const std::string& name);
  /// A mapping that has every key which the reader asks for, with a value that the reader accepts
  /// (yaml_recording.h). It records the keys, and finish() finds no mistake. `recording` must
  /// outlive it.
  static YamlMap record(YamlRecording& recording);

  /// Reads a mandatory value. T: bool, int, int64_t, uint32_t, uint64_t, double, std::string.
  template <typename T>
  T require(std::string_view key, const Wanted<T>& wanted = {});

  /// Reads an optional value. Returns `fallback` when the key is missing.
  template <typename T>
  T optional(std::string_view key, T fallback, const Wanted<T>& wanted = {});

  /// Reads a list of scalars. A `count` other than 0 is the required length.
  template <typename T>
  std::vector<T> require_list(std::string_view key, size_t count = 0, const Wanted<T>& wanted = {});
  /// Reads an optional list. Returns `fallback` when the key is missing.
  template <typename T>
  std::vector<T> optional_list(std::string_view key, std::vector<T> fallback, size_t count = 0,
                               const Wanted<T>& wanted = {});

  /// Reads a word and returns the value that it stands for:
  /// `require_choice<Yaw>("yaw", {{"literal", Yaw::kLiteral}, ...})`.
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
    if (!has(key)) return fallback;
    const T value = require_choice(key, choices);
    for (const auto& [word, meaning] : choices) {
      if (meaning == fallback) note_default_word(key, word);
    }
    return value;
  }

  YamlMap require_map(std::string_view key);
  std::optional<YamlMap> optional_map(std::string_view key);
  std::vector<YamlMap> require_map_list(std::string_view key);

  /// Whether the mapping has the key, which is optional.
  bool has(std::string_view key) const;
  /// Whether the mapping has the key. If not, the caller reads another key in its place.
  bool has_in_place_of(std::string_view key) const;

  /// Reports a mistake that only the caller can detect, at the line of `key` (which may have been
  /// read before): reject("rotation_wxyz", "a quaternion of norm 1.2", "norm 1").
  void reject(std::string_view key, std::string_view found, std::string_view wanted);
  /// Reports a key that is not allowed here, whatever its value is, because words that were read
  /// before exclude it. Does nothing if the mapping lacks the key.
  void reject_key(std::string_view key, std::string_view found, std::string_view wanted);
  /// Reports a word that other words exclude.
  void reject_word(std::string_view key, std::string_view found, std::string_view wanted);
  /// Reports an error in another file. Its message stays as it is, because it names that file.
  void reject_file(const Error& error);

  /// Returns the first mistake of the whole file, or the first key that was not read. Call it once,
  /// after all keys were read.
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
  void note_default_word(std::string_view key, std::string_view word);

  std::shared_ptr<Document> document_;
  Mapping* mapping_;
};

}  // namespace bevloc
