// Takes the meaning of each key from the tables of a page of docs/, so that it is written once.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace bevloc::command {

/// Reads every table of a page whose last column is called "meaning" and whose first column names
/// keys, and the first paragraph of every section. Thread-safe, because it is immutable.
///
/// A table describes the keys of the section above it ("## `cameras`"), or those of the mappings
/// that the line before it names in code marks ("Each entry of `controls`:"). After a line "Keys of
/// ...:", and in a section without code marks, its keys may lie at any depth.
class PageTexts {
 public:
  explicit PageTexts(std::string_view page);

  /// Returns the meaning of the key with this whole path ("simulation.faults[].kind"), or an empty
  /// text if the page has none.
  std::string meaning(const std::string& path) const;

  /// Returns the first paragraph of a section, without a leading "Optional.", or an empty text if a
  /// table comes first.
  std::string introduction(const std::string& section) const;

 private:
  class Reader;

  struct Row {
    std::string mapping;  ///< such as "can.vehicle"; empty for the whole file
    bool any_depth = false;
    std::string key;  ///< such as "signal" or "signals.vehicle"
    std::string text;
  };

  std::vector<Row> rows_;  ///< in the order of the page
  std::map<std::string, std::string> introductions_;
};

/// docs/configuration.md and docs/bring-your-own.md, as they were when the program was built.
std::string_view configuration_page();
std::string_view bring_your_own_page();

}  // namespace bevloc::command
