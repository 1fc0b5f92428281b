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

std::string without_lists(const std::string& path) {
  return std::regex_replace(path, std::regex("\\[\\]"), "");
}

}  // namespace

/// Reads a page line by line.
class PageTexts::Reader {
 public:
  explicit Reader(PageTexts& texts) : texts_(texts) {}

  void add(const std::string& line) {
    const bool is_row = line.starts_with("|");
    if (line.starts_with("## ")) {
      begin_section(line);
    } else if (is_row) {
      add_row(cells_of(line));
    } else if (!line.empty()) {
      add_text(line);
    } else if (introduces_ && !texts_.introductions_[heading_].empty()) {
      introduces_ = false;
    }
    in_table_ = is_row;
  }

 private:
  /// The mappings whose keys a table describes.
  struct Place {
    std::vector<std::string> mappings;
    bool any_depth = false;
  };

  void begin_section(const std::string& line) {
    heading_ = plain(line.substr(3));
    const std::vector<std::string> names = names_in(line);
    section_ = names.empty() ? "" : names.front();
    introduces_ = true;
    lead_.clear();
  }

  void add_row(const std::vector<std::string>& cells) {
    introduces_ = false;
    if (!in_table_) return begin_table(cells);
    if (!has_meanings_) return;
    for (const std::string& key : names_in(cells.front())) {
      for (const std::string& mapping : place_.mappings) {
        texts_.rows_.push_back({mapping, place_.any_depth, key, plain(cells.back())});
      }
    }
  }

  void begin_table(const std::vector<std::string>& header) {
    has_meanings_ = header.size() > 1 && header.back() == "meaning";
    place_ = place_of_table();
    lead_.clear();
  }

  /// The place of the table that begins here.
  Place place_of_table() const {
    Place place{{section_}, section_.empty()};
    if (!lead_.ends_with(":")) return place;
    place.any_depth |= lead_.starts_with("Keys of ");
    const std::vector<std::string> names = names_in(lead_);
    if (names.empty()) return place;
    place.mappings.clear();
    for (const std::string& name : names) {
      const bool is_whole = section_.empty() || name.starts_with(section_ + ".");
      place.mappings.push_back(is_whole ? name : section_ + "." + name);
    }
    return place;
  }

  void add_text(const std::string& line) {
    lead_ = line;
    if (!introduces_) return;
    std::string& text = texts_.introductions_[heading_];
    text += (text.empty() ? "" : " ") + plain(line);
  }

  PageTexts& texts_;
  std::string heading_;
  std::string section_;        ///< the name in the heading; empty if it has none
  std::string lead_;           ///< the latest line outside of tables
  Place place_;                ///< of the latest table
  bool has_meanings_ = false;  ///< whether the latest table describes keys
  bool in_table_ = false;
  bool introduces_ = false;  ///< whether the next text belongs to the section's first paragraph
};

PageTexts::PageTexts(std::string_view page) {
  std::istringstream lines{std::string(page)};
  Reader reader(*this);
  for (std::string line; std::getline(lines, line);) reader.add(line);
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
