// Finds out for each key under which words it is required, optional or not allowed.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "command/schema/reader_passes.h"

namespace bevloc::command {

/// What a key is under some options, or nothing if it is not allowed.
using KeyState = std::optional<YamlKey>;

/// One key under all options.
struct KeyConditions {
  std::string path;
  std::vector<std::string> decisions;  ///< the decisions that matter for this key
  /// The state for each combination of their options, in the order of `decisions`. "" stands for a
  /// decision that these options do not reach.
  std::map<std::vector<std::string>, KeyState> states;

  /// Returns the states in which the key is allowed, each once. States that differ only in
  /// `required` count as one.
  std::vector<YamlKey> forms() const;
};

/// Returns the conditions of all keys, in the order of reading.
std::vector<KeyConditions> conditions_of(const ReaderPasses& reader);

/// The conditions under which a word is not allowed. KeyConditions::path is the path of its key,
/// and a state without a value excludes the word.
struct WordConditions {
  std::string word;
  KeyConditions conditions;
};
std::vector<WordConditions> excluded_words(const ReaderPasses& reader);

}  // namespace bevloc::command
