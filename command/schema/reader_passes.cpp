#include "command/schema/reader_passes.h"

#include <algorithm>
#include <deque>

namespace bevloc::command {
namespace {

using Options = std::map<std::string, std::string>;

bool is_below(const std::string& path, const std::string& ancestor) {
  return path.starts_with(ancestor) &&
         (path.size() == ancestor.size() || path[ancestor.size()] == '.' ||
          path[ancestor.size()] == '[');
}

YamlRecording record(const KeyReader& reader, const Options& options) {
  YamlRecording recording;
  recording.options = options;
  YamlMap yaml = YamlMap::record(recording);
  reader(yaml);
  return recording;
}

bool is_rejected(const YamlRecording& recording, const std::string& path) {
  return std::ranges::any_of(recording.rejected_keys, [&path](const std::string& ancestor) {
    return is_below(path, ancestor);
  });
}

std::map<std::string, YamlKey> keys_of(const YamlRecording& recording) {
  std::map<std::string, YamlKey> keys;
  for (const YamlKey& key : recording.keys) {
    if (!is_rejected(recording, key.path)) keys.emplace(key.path, key);
  }
  return keys;
}

/// Whether the decision is in a section that this pass rejects. Then it changes nothing in this
/// pass, and another pass decides.
bool has_no_effect(const YamlRecording& recording, const YamlDecision& decision) {
  return is_rejected(recording, parent_of(decision.path));
}

/// Whether another option of this decision changes any other key.
bool changes_others(const YamlRecording& a, const YamlRecording& b, const std::string& decision) {
  if (a.rejected_words != b.rejected_words) return true;
  auto keys_a = keys_of(a);
  auto keys_b = keys_of(b);
  keys_a.erase(decision);
  keys_b.erase(decision);
  return keys_a != keys_b;
}

/// Returns the decisions that matter. To find them, takes each option of each decision once, with
/// the first options of all others.
std::map<std::string, std::vector<std::string>> find_decisions(const KeyReader& reader) {
  std::map<std::string, std::vector<std::string>> found;
  std::set<std::string> seen;
  std::deque<Options> open{{}};
  while (!open.empty()) {
    const Options options = open.front();
    open.pop_front();
    const YamlRecording base = record(reader, options);
    for (const YamlDecision& decision : base.decisions) {
      if (has_no_effect(base, decision) || !seen.insert(decision.path).second) continue;
      for (const std::string& option : decision.options) {
        if (option == decision.taken) continue;
        Options changed = options;
        changed[decision.path] = option;
        if (changes_others(base, record(reader, changed), decision.path)) {
          found[decision.path] = decision.options;
        }
        open.push_back(std::move(changed));
      }
    }
  }
  return found;
}

void take(const KeyReader& reader, const Options& options, ReaderPasses& all) {
  const YamlRecording recording = record(reader, options);
  for (const YamlDecision& decision : recording.decisions) {
    if (!all.decisions.contains(decision.path) || options.contains(decision.path)) continue;
    if (has_no_effect(recording, decision)) continue;
    for (const std::string& option : decision.options) {
      Options more = options;
      more[decision.path] = option;
      take(reader, more, all);
    }
    return;
  }
  all.passes.push_back({options, keys_of(recording), recording.rejected_words});
  for (const YamlKey& key : recording.keys) {
    if (std::ranges::find(all.paths, key.path) == all.paths.end()) all.paths.push_back(key.path);
  }
}

}  // namespace

ReaderPasses explore(const KeyReader& reader) {
  ReaderPasses all;
  all.decisions = find_decisions(reader);
  take(reader, {}, all);
  return all;
}

std::string parent_of(const std::string& path) {
  const size_t dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}

std::string name_of_key(const std::string& path) {
  const size_t dot = path.rfind('.');
  return dot == std::string::npos ? path : path.substr(dot + 1);
}

}  // namespace bevloc::command
