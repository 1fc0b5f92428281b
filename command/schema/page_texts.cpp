#include "command/schema/page_texts.h"

#include <regex>
#include <sstream>
#include <vector>

namespace bevloc::command {
namespace {

/// Without links, code marks and emphasis.
std::string plain(const std::string& markdown) {
  std::string text = std::regex_replace(markdown, std::regex(R"re(\[([^\]]*)\]\([^)]*\))re"), "$1");
  std::erase(text, '`');
  std::erase(text, '*');
  return text;
}

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? ""
                                    : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> cells;
  std::istringstream stream(row.substr(1));
  for (std::string cell; std::getline(stream, cell, '|');) cells.push_back(trimmed(cell));
  return cells;
}

/// The last word of each name in code marks: "fx_px", "translation_m" of
/// "vehicle_from_camera.translation_m".
std::vector<std::string> keys_of_cell(const std::string& cell) {
  std::vector<std::string> keys;
  const std::regex key("`(?:\\w+\\.)*(\\w+)`");
  for (std::sregex_iterator match(cell.begin(), cell.end(), key), end; match != end; ++match) {
    keys.push_back((*match)[1].str());
  }
  return keys;
}

}  // namespace

PageTexts::PageTexts(std::string_view page) {
  std::istringstream lines{std::string(page)};
  std::string section;
  bool has_meanings = false;
  bool in_table = false;
  bool introduces = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("## ")) {
      section = plain(line.substr(3));
      introduces = true;
    } else if (line.starts_with("|")) {
      const std::vector<std::string> cells = cells_of(line);
      if (!in_table) has_meanings = cells.size() > 1 && cells.back() == "meaning";
      if (in_table && has_meanings) {
        for (const std::string& key : keys_of_cell(cells.front())) {
          meanings_.try_emplace({section, key}, plain(cells.back()));
        }
      }
    } else if (introduces && !line.empty()) {
      std::string& text = introductions_[section];
      text += (text.empty() ? "" : " ") + plain(line);
    } else if (introduces && !introductions_[section].empty()) {
      introduces = false;
    }
    in_table = line.starts_with("|");
  }
}

std::string PageTexts::meaning(const std::string& section, const std::string& key) const {
  for (const auto& [place, text] : meanings_) {
    if ((section.empty() || place.first == section) && place.second == key) return text;
  }
  return "";
}

std::string PageTexts::introduction(const std::string& section) const {
  const auto found = introductions_.find(section);
  if (found == introductions_.end()) return "";
  const std::string& text = found->second;
  const std::string optional = "Optional.";
  return text.starts_with(optional) ? trimmed(text.substr(optional.size())) : text;
}

}  // namespace bevloc::command
