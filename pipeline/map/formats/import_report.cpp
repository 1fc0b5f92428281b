#include "pipeline/map/formats/import_report.h"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pipeline/map/class_names.h"

namespace bevloc {
namespace {

constexpr size_t kMostExamples = 3;

/// At this distance a grid that is turned by 2 degrees is 100 m off.
constexpr double kFarFromOrigin_m = 3'000.0;

}  // namespace

std::string text_of(const Meaning& meaning) {
  const std::string_view look = name_of(meaning.appearance);
  return meaning.appearance == Appearance::kUnknown
             ? std::string(name_of(meaning.element_class))
             : fmt::format("{}, {}", name_of(meaning.element_class), look);
}

ImportRow& ImportReport::count(std::string_view kind, const std::optional<Meaning>& meaning,
                               std::string_view why, std::string_view where) {
  auto row = std::ranges::find_if(rows_, [&](const ImportRow& other) {
    return other.kind == kind && other.meaning == meaning && other.why == why;
  });
  if (row == rows_.end()) {
    rows_.push_back({std::string(kind), meaning, std::string(why), 0, 0.0, {}});
    row = rows_.end() - 1;
  }
  ++row->count;
  if (row->examples.size() < kMostExamples) row->examples.emplace_back(where);
  return *row;
}

void ImportReport::note(std::string_view kind, const std::optional<Meaning>& meaning,
                        std::string_view why, double length_m, std::string_view where) {
  count(kind, meaning, why, where).length_m += length_m;
}

void ImportReport::note_without_line(std::string_view kind, std::string_view why,
                                     std::string_view where) {
  count(kind, std::nullopt, why, where).has_line = false;
}

void ImportReport::remark_shift(const Eigen::Vector2d& shift) {
  remark(fmt::format("all coordinates were shifted by ({:.0f}, {:.0f}) m", shift.x(), shift.y()));
}

void ImportReport::remark_far_origin(const Eigen::Vector2d& middle) {
  if (middle.norm() <= kFarFromOrigin_m) return;
  remark(fmt::format(
      "--origin: the middle of the map is {:.1f} km from (0, 0), so x must point to true east at "
      "(0, 0), which it does not in MGRS and UTM grids; if a Lanelet2 map has MGRS coordinates, "
      "add the tag mgrs_code to its nodes and leave --origin out",
      middle.norm() / 1000.0));
}

std::vector<ImportRow> ImportReport::rows() const {
  std::vector<ImportRow> sorted = rows_;
  std::ranges::stable_sort(sorted, [](const ImportRow& a, const ImportRow& b) {
    return std::tuple(!a.meaning, std::string_view(a.kind)) <
           std::tuple(!b.meaning, std::string_view(b.kind));
  });
  return sorted;
}

std::string text_of(const ImportReport& report) {
  std::string text;
  for (const std::string& remark : report.remarks()) text += remark + "\n";
  const char* heading = "";
  for (const ImportRow& row : report.rows()) {
    const char* part = row.meaning ? "taken" : "dropped";
    if (part != heading) text += fmt::format("{}:\n", part);
    heading = part;
    std::string fate = row.meaning ? text_of(*row.meaning) : row.why;
    if (row.meaning && !row.why.empty()) fate += fmt::format(" ({})", row.why);
    text += fmt::format("  {:5} {:9.1f} m  {:<34} {}; {}\n", row.count, row.length_m, row.kind,
                        fate, fmt::join(row.examples, ", "));
  }
  return text;
}

}  // namespace bevloc
