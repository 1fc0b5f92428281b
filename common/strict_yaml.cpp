#include "common/strict_yaml.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <deque>
#include <sstream>
#include <type_traits>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "common/files.h"

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
  const Mapping* lacking = nullptr;  ///< the mapping that lacks a key, if that is the mistake

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

int line_of(const YAML::Node& node) {
  return node.Mark().line + 1;
}

std::string describe(const YAML::Node& node) {
  switch (node.Type()) {
    case YAML::NodeType::Scalar:
      return node.Tag() == "!" ? fmt::format("\"{}\"", node.Scalar()) : node.Scalar();
    case YAML::NodeType::Sequence:
      return fmt::format("a list of {}", node.size());
    case YAML::NodeType::Map:
      return "a mapping";
    default:
      return "nothing";
  }
}

template <typename T>
constexpr std::string_view type_name() {
  if constexpr (std::is_same_v<T, bool>) {
    return "true or false";
  } else if constexpr (std::is_same_v<T, std::string>) {
    return "a text";
  } else if constexpr (std::is_floating_point_v<T>) {
    return "a number";
  } else {
    return "a whole number";
  }
}

template <typename T>
std::string describe_wanted(const Wanted<T>& wanted) {
  if (wanted.description.empty()) return std::string(type_name<T>());
  if constexpr (std::is_arithmetic_v<T>) {
    return fmt::format("{}, {}", type_name<T>(), wanted.description);
  }
  return wanted.description;
}

template <typename T>
std::optional<T> number_from(std::string_view text) {
  T value{};
  std::from_chars_result result{};
  const char* end = text.data() + text.size();
  if constexpr (std::is_floating_point_v<T>) {
    result = std::from_chars(text.data(), end, value);
    if (!std::isfinite(value)) return std::nullopt;
  } else {
    const bool is_hex = text.starts_with("0x");
    result = std::from_chars(text.data() + (is_hex ? 2 : 0), end, value, is_hex ? 16 : 10);
  }
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return value;
}

template <typename T>
std::optional<T> scalar_from(const YAML::Node& node) {
  if (!node.IsScalar()) return std::nullopt;
  const std::string& text = node.Scalar();
  if constexpr (std::is_same_v<T, std::string>) {
    return text;
  } else {
    const bool is_quoted = node.Tag() == "!";
    if (is_quoted) return std::nullopt;
    if constexpr (std::is_same_v<T, bool>) {
      if (text == "true") return true;
      if (text == "false") return false;
      return std::nullopt;
    } else {
      return number_from<T>(text);
    }
  }
}

template <typename T>
std::optional<T> accepted_scalar(const YAML::Node& node, const Wanted<T>& wanted) {
  const std::optional<T> value = scalar_from<T>(node);
  return value && wanted.accepts && !wanted.accepts(*value) ? std::nullopt : value;
}

/// Takes a document apart and keeps nothing of it.
class IgnoringHandler : public YAML::EventHandler {
  using Mark = YAML::Mark;
  using Text = std::string;
  using Style = YAML::EmitterStyle::value;
  void OnDocumentStart(const Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const Mark&, YAML::anchor_t) override {}
  void OnAlias(const Mark&, YAML::anchor_t) override {}
  void OnScalar(const Mark&, const Text&, YAML::anchor_t, const Text&) override {}
  void OnSequenceStart(const Mark&, const Text&, YAML::anchor_t, Style) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const Mark&, const Text&, YAML::anchor_t, Style) override {}
  void OnMapEnd() override {}
};

/// The number of documents in a text, up to 2. YAML::LoadAll() reads documents without end from
/// some texts, such as a single comma.
int count_documents(const std::string& text) {
  constexpr int kEnough = 2;
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  IgnoringHandler handler;
  int count = 0;
  while (count < kEnough && parser.HandleNextDocument(handler)) ++count;
  return count;
}

/// Parses a text that holds exactly one YAML document.
Result<YAML::Node> parse_document(const std::string& text, const std::string& name) {
  try {
    const int documents = count_documents(text);
    if (documents > 1) return fail("{}: found 2 YAML documents or more, wanted one", name);
    if (documents < 1) return fail("{}: found 0 YAML documents, wanted one", name);
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    return fail("{}:{}: found text that is not YAML ({}), wanted YAML", name, error.mark.line + 1,
                error.msg);
  }
}

}  // namespace

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
  const Result<std::string> text = bevloc::read_file(path);
  if (!text) return tl::unexpected(text.error());
  return parse(*text, path.string());
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

bool YamlMap::has(std::string_view key) const {
  return mapping_->find(key) != nullptr;
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
  const Entry* entry = use_required(key, describe_wanted(wanted));
  if (entry == nullptr) return T{};
  if (const std::optional<T> value = accepted_scalar<T>(entry->node, wanted)) return *value;
  document_->report(entry->line, mapping_->path_of(key), describe(entry->node),
                    describe_wanted(wanted));
  return T{};
}

template <typename T>
T YamlMap::optional(std::string_view key, T fallback, const Wanted<T>& wanted) {
  return has(key) ? require<T>(key, wanted) : fallback;
}

template <typename T>
std::vector<T> YamlMap::require_list(std::string_view key, size_t count, const Wanted<T>& wanted) {
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

size_t YamlMap::require_word(std::string_view key, const std::vector<std::string_view>& words) {
  const Wanted<std::string> wanted{
      fmt::format("one of {}", fmt::join(words, ", ")), [&words](const std::string& word) {
        return std::find(words.begin(), words.end(), word) != words.end();
      }};
  const auto found = std::find(words.begin(), words.end(), require<std::string>(key, wanted));
  return found == words.end() ? 0 : static_cast<size_t>(found - words.begin());
}

YamlMap YamlMap::require_map(std::string_view key) {
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

void YamlMap::reject(std::string_view key, std::string_view found, std::string_view wanted) {
  const Entry* entry = mapping_->find(key);
  document_->report(entry != nullptr ? entry->line : mapping_->line, mapping_->path_of(key), found,
                    wanted);
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

#define BEVLOC_YAML_SCALAR(T)                                             \
  template T YamlMap::require<T>(std::string_view, const Wanted<T>&);     \
  template T YamlMap::optional<T>(std::string_view, T, const Wanted<T>&); \
  template std::vector<T> YamlMap::require_list<T>(std::string_view, size_t, const Wanted<T>&);
BEVLOC_YAML_SCALAR(bool)
BEVLOC_YAML_SCALAR(int)
BEVLOC_YAML_SCALAR(int64_t)
BEVLOC_YAML_SCALAR(uint32_t)
BEVLOC_YAML_SCALAR(uint64_t)
BEVLOC_YAML_SCALAR(double)
BEVLOC_YAML_SCALAR(std::string)
#undef BEVLOC_YAML_SCALAR

}  // namespace bevloc
