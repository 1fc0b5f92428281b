#include "command/schema/key_conditions.h"

#include <algorithm>
#include <functional>
#include <set>

namespace bevloc::command {
namespace {

/// What a pass says about a key, or nothing if the mapping around the key is missing in this pass.
using Observation = std::optional<KeyState>;

/// Two passes that differ in the option of one decision.
struct Pair {
  size_t a;
  size_t b;
  std::string decision;
};

/// Returns the only decision with different options in both passes, or an empty text if there is
/// none or more than one.
std::string only_difference(const ReaderPass& a, const ReaderPass& b) {
  std::string decision;
  for (const auto& [path, option] : a.options) {
    const auto other = b.options.find(path);
    if (other == b.options.end() || other->second == option) continue;
    if (!decision.empty()) return "";
    decision = path;
  }
  return decision;
}

std::vector<Pair> pairs_of(const ReaderPasses& reader) {
  std::vector<Pair> pairs;
  for (size_t a = 0; a < reader.passes.size(); ++a) {
    for (size_t b = a + 1; b < reader.passes.size(); ++b) {
      std::string decision = only_difference(reader.passes[a], reader.passes[b]);
      if (!decision.empty()) pairs.push_back({a, b, std::move(decision)});
    }
  }
  return pairs;
}

/// Returns the conditions of one key: which decisions matter for it, and its state for each
/// combination of their options. `observe` gives the state of the key in one pass.
KeyConditions conditions_from(const ReaderPasses& reader, const std::vector<Pair>& pairs,
                              std::string path,
                              const std::function<Observation(const ReaderPass&)>& observe) {
  KeyConditions conditions;
  conditions.path = std::move(path);
  std::vector<Observation> seen;
  for (const ReaderPass& pass : reader.passes) seen.push_back(observe(pass));
  std::set<std::string> decisions;
  for (const Pair& pair : pairs) {
    if (seen[pair.a] && seen[pair.b] && seen[pair.a] != seen[pair.b]) {
      decisions.insert(pair.decision);
    }
  }
  conditions.decisions.assign(decisions.begin(), decisions.end());
  for (size_t i = 0; i < seen.size(); ++i) {
    if (!seen[i]) continue;
    std::vector<std::string> options;
    for (const std::string& decision : conditions.decisions) {
      const auto taken = reader.passes[i].options.find(decision);
      options.push_back(taken == reader.passes[i].options.end() ? "" : taken->second);
    }
    conditions.states.emplace(std::move(options), *seen[i]);
  }
  return conditions;
}

bool has_parent(const ReaderPass& pass, const std::string& path) {
  std::string parent = parent_of(path);
  if (parent.ends_with("[]")) parent.resize(parent.size() - 2);
  return parent.empty() || pass.keys.contains(parent);
}

Observation observe_key(const ReaderPass& pass, const std::string& path) {
  if (!pass.rejected_words.empty() || !has_parent(pass, path)) return std::nullopt;
  const auto own = pass.options.find(path);
  if (own != pass.options.end() && own->second == YamlRecording::kAbsent) return std::nullopt;
  const auto key = pass.keys.find(path);
  return key == pass.keys.end() ? KeyState() : KeyState(key->second);
}

}  // namespace

std::vector<YamlKey> KeyConditions::forms() const {
  std::vector<YamlKey> all;
  for (const auto& [options, state] : states) {
    if (!state) continue;
    YamlKey form = *state;
    form.required = false;
    if (std::ranges::find(all, form) == all.end()) all.push_back(std::move(form));
  }
  return all;
}

std::vector<KeyConditions> conditions_of(const ReaderPasses& reader) {
  const std::vector<Pair> pairs = pairs_of(reader);
  std::vector<KeyConditions> all;
  for (const std::string& path : reader.paths) {
    KeyConditions conditions = conditions_from(
        reader, pairs, path, [&path](const ReaderPass& pass) { return observe_key(pass, path); });
    // A key that is never allowed is left out.
    if (!conditions.forms().empty()) all.push_back(std::move(conditions));
  }
  return all;
}

std::vector<WordConditions> excluded_words(const ReaderPasses& reader) {
  std::set<std::pair<std::string, std::string>> words;
  for (const ReaderPass& pass : reader.passes) {
    for (const std::string& path : pass.rejected_words) {
      const auto word = pass.options.find(path);
      if (word != pass.options.end()) words.emplace(path, word->second);
    }
  }
  const std::vector<Pair> pairs = pairs_of(reader);
  std::vector<WordConditions> all;
  for (const auto& [path, word] : words) {
    const auto observe = [&path = path, &word = word](const ReaderPass& pass) -> Observation {
      const auto taken = pass.options.find(path);
      if (taken == pass.options.end() || taken->second != word) return std::nullopt;
      return pass.rejected_words.contains(path) ? KeyState() : KeyState(YamlKey{});
    };
    all.push_back({word, conditions_from(reader, pairs, path, observe)});
  }
  return all;
}

}  // namespace bevloc::command
