// Line numbers of positions in a text.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

namespace bevloc {

/// Finds the line number (from 1) of a position in a text.
class LineFinder {
 public:
  explicit LineFinder(std::string_view text) {
    for (size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') line_ends_.push_back(static_cast<std::ptrdiff_t>(i));
    }
  }
  int line_at(std::ptrdiff_t offset) const {
    return static_cast<int>(std::lower_bound(line_ends_.begin(), line_ends_.end(), offset) -
                            line_ends_.begin()) +
           1;
  }

 private:
  std::vector<std::ptrdiff_t> line_ends_;
};

}  // namespace bevloc
