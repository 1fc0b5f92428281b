// Finds out all keys of a reader of YAML by running it with every combination of words that changes
// what it asks for.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/strict_yaml.h"

namespace bevloc::command {

/// A function that reads all keys of a file, such as firmware::read_config().
using KeyReader = std::function<void(YamlMap& yaml)>;

/// The keys that the reader asks for when these options are taken.
struct ReaderPass {
  std::map<std::string, std::string> options;  ///< options of the decisions, by path
  std::map<std::string, YamlKey> keys;         ///< by path, without those that are not allowed
  std::set<std::string> rejected_words;        ///< not empty if the options exclude each other
};

/// Everything that the reader asks for in all its passes.
struct ReaderPasses {
  std::vector<ReaderPass> passes;
  std::vector<std::string> paths;  ///< paths of all keys, in the order of reading
  /// The options of each decision that changes which keys are read, or how.
  std::map<std::string, std::vector<std::string>> decisions;
};

/// Takes one pass for each combination of the options that matter.
ReaderPasses explore(const KeyReader& reader);

/// Returns the path of the mapping around a key: "simulation.faults[]" for
/// "simulation.faults[].kind". It is empty for a key of the file.
std::string parent_of(const std::string& path);
/// Returns the name of a key: "kind" for "simulation.faults[].kind".
std::string name_of_key(const std::string& path);

}  // namespace bevloc::command
