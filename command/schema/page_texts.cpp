#include "command/schema/page_texts.h"

#include <regex>
#include <sstream>
#include <vector>

namespace bevloc::command {
namespace {

/// Returns the text without links, code marks and emphasis.
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

/// Returns the names in code marks, such as "fx_px" and "vehicle_from_camera.translation_m".
std::vector<std::string> names_in(const std::string& text) {
  std::vector<std::string> names;
  const std::regex name("`(\\w+(?:\\.\\w+)*)`");
  for (std::sregex_iterator match(text.begin(), text.end(), name), end; match != end; ++match) {
    names.push_back((*match)[1].str());
  }
  return names;
}

/// The mappings whose keys a table describes.
struct Place {
  std::vector<std::string> mappings;
  bool any_depth = false;
};

/// Returns the place of a table. `section` has no code marks, and is empty if its heading has none.
/// `lead` is the line before the table.
Place place_of(const std::string& section, const std::string& lead) {
  Place place{{section}, section.empty()};
  if (!lead.ends_with(":")) return place;
  place.any_depth |= lead.starts_with("Keys of ");
  const std::vector<std::string> names = names_in(lead);
  if (names.empty()) return place;
  place.mappings.clear();
  for (const std::string& name : names) {
    const bool is_whole = section.empty() || name.starts_with(section + ".");
    place.mappings.push_back(is_whole ? name : section + "." + name);
  }
  return place;
}

std::string without_lists(const std::string& path) {
  return std::regex_replace(path, std::regex("\\[\\]"), "");
}

}  // namespace

PageTexts::PageTexts(std::string_view page) {
  std::istringstream lines{std::string(page)};
  std::string heading;
  std::string section;
  std::string lead;
  Place place;
  bool has_meanings = false;
  bool in_table = false;
  bool introduces = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("## ")) {
      heading = plain(line.substr(3));
      const std::vector<std::string> names = names_in(line);
      section = names.empty() ? "" : names.front();
      introduces = true;
      lead.clear();
    } else if (line.starts_with("|")) {
      introduces = false;
      const std::vector<std::string> cells = cells_of(line);
      if (!in_table) {
        has_meanings = cells.size() > 1 && cells.back() == "meaning";
        place = place_of(section, lead);
        lead.clear();
      } else if (has_meanings) {
        for (const std::string& key : names_in(cells.front())) {
          for (const std::string& mapping : place.mappings) {
            rows_.push_back({mapping, place.any_depth, key, plain(cells.back())});
          }
        }
      }
    } else if (!line.empty()) {
      lead = line;
      if (introduces) {
        std::string& text = introductions_[heading];
        text += (text.empty() ? "" : " ") + plain(line);
      }
    } else if (introduces && !introductions_[heading].empty()) {
      introduces = false;
    }
    in_table = line.starts_with("|");
  }
}

std::string PageTexts::meaning(const std::string& path) const {
  const std::string whole = without_lists(path);
  const Row* best = nullptr;
  for (const Row& row : rows_) {
    const std::string start = row.mapping.empty() ? "" : row.mapping + ".";
    if (whole == start + row.key) return row.text;
    if (!row.any_depth || !whole.starts_with(start) || !whole.ends_with("." + row.key)) continue;
    if (best == nullptr || row.key.size() > best->key.size()) best = &row;
  }
  return best == nullptr ? "" : best->text;
}

std::string PageTexts::introduction(const std::string& section) const {
  const auto found = introductions_.find(section);
  if (found == introductions_.end()) return "";
  const std::string& text = found->second;
  const std::string optional = "Optional.";
  return text.starts_with(optional) ? trimmed(text.substr(optional.size())) : text;
}

}  // namespace bevloc::command
