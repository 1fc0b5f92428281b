// Charts and maps as inline SVG.
#pragma once

#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "evaluation/report/report_data.h"

namespace bevloc::evaluation {

struct Series {
  std::string name;
  std::string_view color;
  std::vector<TimedValue> points;
};

/// Values over time. Axes begin at second 0; the values' axis covers all points and zero.
std::string line_chart(std::string_view title, std::string_view unit,
                       const std::vector<Series>& series, double length_s);

/// The states over time as a bar.
std::string state_bar(const std::vector<StatePeriod>& periods, double length_s);

/// The track in the colours of its states, the truth, and the map around them. Both lines are
/// interrupted where nothing is recorded. North is up.
std::string track_map(const ReportData& data);

std::string_view color_of(HealthState state);

/// Text that may stand in HTML.
std::string escaped(std::string_view text);

/// Appends formatted text.
template <typename... T>
void append(std::string& text, fmt::format_string<T...> format, T&&... values) {
  fmt::format_to(std::back_inserter(text), format, std::forward<T>(values)...);
}

}  // namespace bevloc::evaluation
