// Records which keys a reader of YAML asks for, so that a schema can be made from the reader
// itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace bevloc {

enum class YamlType : uint8_t { kFlag, kWholeNumber, kCount, kNumber, kText, kMap };

/// A condition on a value: the limits of a number, or the limits of the length of a text.
struct YamlLimits {
  std::optional<double> low{};
  std::optional<double> high{};
  bool excludes_low = false;
  std::vector<std::string> words{};  ///< if not empty, the text must be one of these

  bool operator==(const YamlLimits&) const = default;
};

/// One key as its reader wants it.
struct YamlKey {
  std::string path;  ///< "cameras.driver", "simulation.faults[].kind"
  YamlType type = YamlType::kMap;
  bool is_list = false;
  size_t count = 0;  ///< the number of items of a list; 0 if any number is allowed
  YamlLimits limits{};
  bool required = true;
  std::string default_text{};  ///< as JSON; empty if there is none, or JSON cannot express it

  bool operator==(const YamlKey&) const = default;
};

/// A key that decides which other keys the reader asks for. It is a key with words, or a key that
/// stands in place of another one. The options of the latter are kPresent and kAbsent.
struct YamlDecision {
  std::string path;
  std::vector<std::string> options;
  std::string taken;
};

/// The keys that a reader asks for in one pass over YamlMap::record(). They depend on the words
/// that it has read, so all keys appear only in several passes, each with its own `options`. One
/// thread.
struct YamlRecording {
  static constexpr const char* kPresent = "?present";
  static constexpr const char* kAbsent = "?absent";

  /// The option that this pass takes for each path. Without an entry it takes the first option.
  std::map<std::string, std::string> options;

  std::vector<YamlKey> keys;             ///< in the order of reading
  std::vector<YamlDecision> decisions;   ///< in the order of reading
  std::set<std::string> rejected_keys;   ///< keys that are not allowed in this pass
  std::set<std::string> rejected_words;  ///< paths of keys whose words this pass excludes
  std::set<std::string> tested;          ///< keys that the reader looked for: they are optional

  /// Records a key. Returns the word that this pass takes, or an empty text for a key without
  /// words.
  std::string add(YamlKey key) {
    key.required = !tested.contains(key.path);
    std::string word;
    if (!key.limits.words.empty() && !key.is_list) word = decide(key.path, key.limits.words);
    if (word.empty() && !key.limits.words.empty()) word = key.limits.words.front();
    keys.push_back(std::move(key));
    return word;
  }

  /// Records that the reader tests for a key, which is therefore optional. This pass has the key.
  bool test(const std::string& path) {
    tested.insert(path);
    return true;
  }

  /// Decides whether this pass has a key that another key can replace.
  bool test_in_place_of(const std::string& path) {
    tested.insert(path);
    return decide(path, {kPresent, kAbsent}) == kPresent;
  }

  void note_default(const std::string& path, const std::string& text) {
    for (YamlKey& key : keys) {
      if (key.path == path) key.default_text = text;
    }
  }

 private:
  std::string decide(const std::string& path, const std::vector<std::string>& all) {
    const auto chosen = options.find(path);
    std::string taken = chosen == options.end() ? all.front() : chosen->second;
    decisions.push_back({path, all, taken});
    return taken;
  }
};

}  // namespace bevloc
