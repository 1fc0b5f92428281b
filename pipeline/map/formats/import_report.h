// What an importer took from a map file, what it dropped, and why.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "pipeline/map/hd_map.h"

namespace bevloc {

/// What a line of a file becomes in the map.
struct Meaning {
  ElementClass element_class = ElementClass::kLaneDivider;
  Appearance appearance = Appearance::kUnknown;

  friend bool operator==(const Meaning&, const Meaning&) = default;
};

/// Returns a text such as "lane divider, dashed".
std::string text_of(const Meaning& meaning);

/// All lines of one kind that became the same, or were dropped for the same reason.
struct ImportRow {
  std::string kind;                ///< in the words of the file, such as "road mark solid"
  std::optional<Meaning> meaning;  ///< nothing if they were dropped
  std::string why;                 ///< why they were dropped, or that the class table decided
  size_t count = 0;
  double length_m = 0.0;
  std::vector<std::string> examples;  ///< the first few: element and line
  bool has_line = true;               ///< false for what no rule can make a line of
};

/// One thread.
class ImportReport {
 public:
  /// Counts one line of the file. `where` names it, such as "way 12 (line 340)".
  void note(std::string_view kind, const std::optional<Meaning>& meaning, std::string_view why,
            double length_m, std::string_view where);

  /// Counts one element of the file that has no line of its own, such as a relation or a point.
  void note_without_line(std::string_view kind, std::string_view why, std::string_view where);

  /// A remark on the whole file, such as where its origin comes from.
  void remark(std::string text) { remarks_.push_back(std::move(text)); }

  void remark_shift(const Eigen::Vector2d& shift);

  /// Warns of a wrong direction of x if the middle of the map (m, in the coordinates of the file)
  /// is far from (0, 0), whose place on earth the user gave.
  void remark_far_origin(const Eigen::Vector2d& middle);

  /// The rows of lines that were taken come first. Both parts are sorted by kind.
  std::vector<ImportRow> rows() const;
  const std::vector<std::string>& remarks() const { return remarks_; }

 private:
  /// Counts an element in its row, which is made if it is missing.
  ImportRow& count(std::string_view kind, const std::optional<Meaning>& meaning,
                   std::string_view why, std::string_view where);

  std::vector<ImportRow> rows_;
  std::vector<std::string> remarks_;
};

/// A table for a terminal, with a line feed at its end.
std::string text_of(const ImportReport& report);

}  // namespace bevloc
