#include "common/strict_yaml.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <type_traits>

#include "common/files.h"
#include "common/yaml_scalar.h"
#include "common/yaml_text.h"

namespace bevloc {

struct YamlMap::Entry {
  std::string key;
  int line = 0;
  YAML::Node node;
  bool used = false;
};

struct YamlMap::Mapping {
  std::string path;  ///< dotted keys that lead to this mapping; empty for the root of the file
  int line = 0;
  std::vector<Entry> entries;

  std::string path_of(std::string_view key) const {
    return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
  }
  Entry* find(std::string_view key) {
    const auto entry = std::find_if(entries.begin(), entries.end(),
                                    [key](const Entry& e) { return e.key == key; });
    return entry == entries.end() ? nullptr : &*entry;
  }
  const Entry* first_unused() const {
    const auto entry =
        std::find_if(entries.begin(), entries.end(), [](const Entry& e) { return !e.used; });
    return entry == entries.end() ? nullptr : &*entry;
  }
};

struct YamlMap::Document {
  std::string name;
  std::deque<Mapping> mappings;  ///< in the order of opening; their addresses do not change
  std::optional<std::string> mistake;
  const Mapping* lacking = nullptr;    ///< the mapping that lacks a key, if that is the mistake
  YamlRecording* recording = nullptr;  ///< if set, there is no file, and the keys are recorded

  void report(int line, std::string_view place, std::string_view found, std::string_view wanted) {
    if (mistake) return;
    const std::string_view separator = place.empty() ? "" : ": ";
    mistake =
        fmt::format("{}:{}: {}{}found {}, wanted {}", name, line, place, separator, found, wanted);
  }

  /// Opens a node as a mapping. If it is not a mapping, reports this and returns an empty one.
  Mapping* open(const YAML::Node& node, std::string path, int line);
};

namespace {

template <typename T>
constexpr YamlType yaml_type() {
  if constexpr (std::is_same_v<T, bool>) {
    return YamlType::kFlag;
  } else if constexpr (std::is_same_v<T, std::string>) {
    return YamlType::kText;
  } else if constexpr (std::is_floating_point_v<T>) {
    return YamlType::kNumber;
  } else {
    return std::is_signed_v<T> ? YamlType::kWholeNumber : YamlType::kCount;
  }
}

/// Returns the default as JSON, or an empty text if JSON cannot express it.
template <typename T>
std::string default_text(const T& value) {
  if constexpr (std::is_same_v<T, std::string>) {
    return fmt::format("\"{}\"", value);
  } else {
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) return "";
      // A default that was converted to radians and back has wrong last digits.
      return fmt::format("{:.12g}", value);
    }
    return fmt::format("{}", value);
  }
}

/// Records a key and makes up a value that the reader accepts.
template <typename T>
T recorded(YamlRecording& recording, YamlKey key, const Wanted<T>& wanted) {
  key.type = yaml_type<T>();
  key.limits = wanted.limits;
  const std::string path = key.path;
  const std::string word = recording.add(std::move(key));
  if constexpr (std::is_same_v<T, std::string>) {
    return word.empty() ? path : word;
  } else if constexpr (std::is_same_v<T, bool>) {
    return false;
  } else {
    // Four numbers without limits are a quaternion of norm 1.
    const double low = wanted.limits.low.value_or(std::is_floating_point_v<T> ? 0.5 : 0.0);
    return static_cast<T>(wanted.limits.excludes_low ? low + 1.0 : low);
  }
}

}  // namespace

Wanted<std::string> not_empty(std::string description, size_t longest) {
  return {std::move(description),
          [longest](const std::string& text) { return !text.empty() && text.size() <= longest; },
          {.low = 1.0,
           .high = longest == std::numeric_limits<size_t>::max() ? std::optional<double>()
                                                                 : static_cast<double>(longest)}};
}

Wanted<std::string> one_of(std::vector<std::string> words) {
  return {fmt::format("one of {}", fmt::join(words, ", ")),
          [words](const std::string& word) {
            return std::find(words.begin(), words.end(), word) != words.end();
          },
          {.words = words}};
}

YamlMap::Mapping* YamlMap::Document::open(const YAML::Node& node, std::string path, int line) {
  Mapping& mapping = mappings.emplace_back();
  mapping.path = std::move(path);
  mapping.line = line;
  if (!node.IsMap()) {
    report(line, mapping.path, describe(node), "a mapping");
    return &mapping;
  }
  for (const auto& pair : node) {
    const int key_line = line_of(pair.first);
    if (!pair.first.IsScalar()) {
      report(key_line, mapping.path, fmt::format("{} as a key", describe(pair.first)), "a word");
      continue;
    }
    const std::string& key = pair.first.Scalar();
    if (const Entry* first = mapping.find(key)) {
      report(key_line, mapping.path_of(key),
             fmt::format("the key a second time (the first is in line {})", first->line),
             "each key once");
      continue;
    }
    mapping.entries.push_back({key, key_line, pair.second, false});
  }
  return &mapping;
}

Result<YamlMap> YamlMap::read_file(const std::filesystem::path& path) {
  return parse_file(path, parse);
}

Result<YamlMap> YamlMap::parse(const std::string& text, const std::string& name) {
  const Result<YAML::Node> root = parse_document(text, name);
  if (!root) return tl::unexpected(root.error());
  auto document = std::make_shared<Document>();
  document->name = name;
  Mapping* mapping = document->open(*root, "", line_of(*root));
  if (!root->IsMap()) return tl::unexpected(Error{*document->mistake});
  return YamlMap(std::move(document), mapping);
}

YamlMap YamlMap::record(YamlRecording& recording) {
  auto document = std::make_shared<Document>();
  document->name = "schema";
  document->recording = &recording;
  Mapping* mapping = &document->mappings.emplace_back();
  return YamlMap(std::move(document), mapping);
}

bool YamlMap::has(std::string_view key) const {
  if (YamlRecording* recording = document_->recording) {
    return recording->test(mapping_->path_of(key));
  }
  return mapping_->find(key) != nullptr;
}

bool YamlMap::has_in_place_of(std::string_view key) const {
  if (YamlRecording* recording = document_->recording) {
    return recording->test_in_place_of(mapping_->path_of(key));
  }
  return has(key);
}

YamlMap::Entry* YamlMap::use(std::string_view key) {
  Entry* entry = mapping_->find(key);
  if (entry != nullptr) {
    assert(!entry->used);
    entry->used = true;
  }
  return entry;
}

YamlMap::Entry* YamlMap::use_required(std::string_view key, std::string_view wanted) {
  Entry* entry = use(key);
  if (entry == nullptr && !document_->mistake) {
    document_->report(mapping_->line, mapping_->path_of(key), "no such key", wanted);
    document_->lacking = mapping_;
  }
  return entry;
}

template <typename T>
T YamlMap::require(std::string_view key, const Wanted<T>& wanted) {
  if (YamlRecording* recording = document_->recording) {
    return recorded<T>(*recording, {.path = mapping_->path_of(key)}, wanted);
  }
  const Entry* entry = use_required(key, describe_wanted(wanted));
  if (entry == nullptr) return T{};
  if (const std::optional<T> value = accepted_scalar<T>(entry->node, wanted)) return *value;
  document_->report(entry->line, mapping_->path_of(key), describe(entry->node),
                    describe_wanted(wanted));
  return T{};
}

template <typename T>
T YamlMap::optional(std::string_view key, T fallback, const Wanted<T>& wanted) {
  if (YamlRecording* recording = document_->recording) {
    const std::string path = mapping_->path_of(key);
    recording->test(path);
    YamlKey entry{.path = path, .default_text = default_text(fallback)};
    const T probe = recorded<T>(*recording, std::move(entry), wanted);
    return wanted.limits.words.empty() ? fallback : probe;
  }
  return has(key) ? require<T>(key, wanted) : fallback;
}

template <typename T>
std::vector<T> YamlMap::require_list(std::string_view key, size_t count, const Wanted<T>& wanted) {
  if (YamlRecording* recording = document_->recording) {
    const T item = recorded<T>(
        *recording, {.path = mapping_->path_of(key), .is_list = true, .count = count}, wanted);
    return std::vector<T>(std::max(count, size_t{1}), item);
  }
  const std::string wanted_list = count == 0 ? "a list" : fmt::format("a list of {}", count);
  std::vector<T> values(count);
  const Entry* entry = use_required(key, wanted_list);
  if (entry == nullptr) return values;
  const YAML::Node& list = entry->node;
  if (!list.IsSequence() || (count != 0 && list.size() != count)) {
    document_->report(entry->line, mapping_->path_of(key), describe(list), wanted_list);
    return values;
  }
  values.resize(list.size());
  for (size_t i = 0; i < list.size(); ++i) {
    const YAML::Node item = list[i];
    if (const std::optional<T> value = accepted_scalar<T>(item, wanted)) {
      values[i] = *value;
    } else {
      document_->report(line_of(item), fmt::format("{}[{}]", mapping_->path_of(key), i),
                        describe(item), describe_wanted(wanted));
    }
  }
  return values;
}

template <typename T>
std::vector<T> YamlMap::optional_list(std::string_view key, std::vector<T> fallback, size_t count,
                                      const Wanted<T>& wanted) {
  if (!has(key)) return fallback;
  std::vector<T> values = require_list<T>(key, count, wanted);
  YamlRecording* recording = document_->recording;
  if (recording == nullptr) return values;
  std::vector<std::string> texts;
  for (const auto& value : fallback) texts.push_back(default_text<T>(value));
  recording->note_default(mapping_->path_of(key), fmt::format("[{}]", fmt::join(texts, ", ")));
  return fallback;
}

size_t YamlMap::require_word(std::string_view key, const std::vector<std::string_view>& words) {
  const Wanted<std::string> wanted = one_of({words.begin(), words.end()});
  const auto found = std::find(words.begin(), words.end(), require<std::string>(key, wanted));
  return found == words.end() ? 0 : static_cast<size_t>(found - words.begin());
}

void YamlMap::note_default_word(std::string_view key, std::string_view word) {
  if (YamlRecording* recording = document_->recording) {
    recording->note_default(mapping_->path_of(key), fmt::format("\"{}\"", word));
  }
}

YamlMap YamlMap::require_map(std::string_view key) {
  if (YamlRecording* recording = document_->recording) {
    const std::string path = mapping_->path_of(key);
    recording->add({.path = path, .type = YamlType::kMap});
    Mapping& mapping = document_->mappings.emplace_back();
    mapping.path = path;
    return {document_, &mapping};
  }
  const Entry* entry = use_required(key, "a mapping");
  const YAML::Node node = entry != nullptr ? entry->node : YAML::Node(YAML::NodeType::Map);
  const int line = entry != nullptr ? entry->line : mapping_->line;
  return {document_, document_->open(node, mapping_->path_of(key), line)};
}

std::optional<YamlMap> YamlMap::optional_map(std::string_view key) {
  if (!has(key)) return std::nullopt;
  return require_map(key);
}

std::vector<YamlMap> YamlMap::require_map_list(std::string_view key) {
  std::vector<YamlMap> maps;
  if (YamlRecording* recording = document_->recording) {
    const std::string path = mapping_->path_of(key);
    recording->add({.path = path, .type = YamlType::kMap, .is_list = true});
    Mapping& mapping = document_->mappings.emplace_back();
    mapping.path = path + "[]";
    maps.push_back({document_, &mapping});
    return maps;
  }
  const Entry* entry = use_required(key, "a list of mappings");
  if (entry == nullptr) return maps;
  if (!entry->node.IsSequence()) {
    document_->report(entry->line, mapping_->path_of(key), describe(entry->node),
                      "a list of mappings");
    return maps;
  }
  for (size_t i = 0; i < entry->node.size(); ++i) {
    const YAML::Node item = entry->node[i];
    const std::string path = fmt::format("{}[{}]", mapping_->path_of(key), i);
    maps.push_back({document_, document_->open(item, path, line_of(item))});
  }
  return maps;
}

void YamlMap::reject_key(std::string_view key, std::string_view found, std::string_view wanted) {
  if (document_->recording != nullptr) {
    document_->recording->rejected_keys.insert(mapping_->path_of(key));
  } else if (has(key)) {
    reject(key, found, wanted);
  }
}

void YamlMap::reject_word(std::string_view key, std::string_view found, std::string_view wanted) {
  if (document_->recording != nullptr) {
    document_->recording->rejected_words.insert(mapping_->path_of(key));
  } else {
    reject(key, found, wanted);
  }
}

void YamlMap::reject(std::string_view key, std::string_view found, std::string_view wanted) {
  // A recording's values are made up, so it says nothing about values that contradict each other.
  if (document_->recording != nullptr) return;
  const Entry* entry = mapping_->find(key);
  document_->report(entry != nullptr ? entry->line : mapping_->line, mapping_->path_of(key), found,
                    wanted);
}

void YamlMap::reject_file(const Error& error) {
  if (!document_->mistake) document_->mistake = error.message;
}

Status YamlMap::finish() const {
  if (document_->mistake) {
    // A misspelt key shows up as one missing key and one unknown key, so the message names both.
    const Entry* unknown =
        document_->lacking != nullptr ? document_->lacking->first_unused() : nullptr;
    if (unknown == nullptr) return tl::unexpected(Error{*document_->mistake});
    return fail("{} (line {} has an unknown key {})", *document_->mistake, unknown->line,
                unknown->key);
  }
  for (const Mapping& mapping : document_->mappings) {
    if (const Entry* unknown = mapping.first_unused()) {
      return fail("{}:{}: {}: found an unknown key, wanted only keys that have a meaning here",
                  document_->name, unknown->line, mapping.path_of(unknown->key));
    }
  }
  return {};
}

#define BEVLOC_YAML_SCALAR(T)                                                                   \
  template T YamlMap::require<T>(std::string_view, const Wanted<T>&);                           \
  template T YamlMap::optional<T>(std::string_view, T, const Wanted<T>&);                       \
  template std::vector<T> YamlMap::require_list<T>(std::string_view, size_t, const Wanted<T>&); \
  template std::vector<T> YamlMap::optional_list<T>(std::string_view, std::vector<T>, size_t,   \
                                                    const Wanted<T>&);
BEVLOC_YAML_SCALAR(bool)
BEVLOC_YAML_SCALAR(int)
BEVLOC_YAML_SCALAR(int64_t)
BEVLOC_YAML_SCALAR(uint32_t)
BEVLOC_YAML_SCALAR(uint64_t)
BEVLOC_YAML_SCALAR(double)
BEVLOC_YAML_SCALAR(std::string)
#undef BEVLOC_YAML_SCALAR

}  // namespace bevloc
