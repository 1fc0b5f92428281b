// Takes the meaning of each key from the tables of a page of docs/, so that it is written once.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace bevloc::command {

/// Reads every table of a page whose last column is called "meaning" and whose first column names
/// keys, and the first paragraph of every section. Immutable.
class PageTexts {
 public:
  explicit PageTexts(std::string_view page);

  /// The meaning of a key in a section ("## `cameras`"). Of an empty section: of the first key of
  /// this name. Empty if the page has none.
  std::string meaning(const std::string& section, const std::string& key) const;

  /// The first paragraph of a section, without a leading "Optional."; empty if there is none.
  std::string introduction(const std::string& section) const;

 private:
  std::map<std::pair<std::string, std::string>, std::string> meanings_;
  std::map<std::string, std::string> introductions_;
};

/// docs/configuration.md and docs/bring-your-own.md, as they were when the program was built.
std::string_view configuration_page();
std::string_view bring_your_own_page();

}  // namespace bevloc::command
