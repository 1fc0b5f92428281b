#include "evaluation/report/charts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace bevloc::evaluation {
namespace {

constexpr double kWidth = 960.0;
constexpr double kLeft = 56.0;
constexpr double kRight = 12.0;
constexpr double kTop = 26.0;
constexpr double kPlotHeight = 150.0;
constexpr double kBottom = 22.0;
constexpr double kPlotWidth = kWidth - kLeft - kRight;
/// Points that are farther apart in time are not joined.
constexpr double kGap_s = 0.6;

/// 1, 2 or 5 times a power of ten, so that `range` has about `parts` steps.
double nice_step(double range, double parts) {
  const double rough = range / parts;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10.0 * power;
}

struct Range {
  double low = 0.0;
  double high = 0.0;
};

Range range_of(const std::vector<Series>& series) {
  Range range;
  for (const Series& one : series) {
    for (const TimedValue& point : one.points) {
      range.low = std::min(range.low, point.value);
      range.high = std::max(range.high, point.value);
    }
  }
  if (range.high - range.low < 1e-9) range.high = range.low + 1.0;
  return range;
}

void add_time_axis(std::string& svg, double length_s, double top, double bottom) {
  const double step_s = nice_step(std::max(length_s, 0.1), 10.0);
  for (double time_s = 0.0; time_s <= length_s + 1e-9; time_s += step_s) {
    const double x = kLeft + kPlotWidth * time_s / std::max(length_s, 0.1);
    append(svg, "<line x1='{0:.1f}' x2='{0:.1f}' y1='{1:.1f}' y2='{2:.1f}' class='grid'/>", x, top,
           bottom);
    append(svg, "<text x='{:.1f}' y='{:.1f}' class='tick' text-anchor='middle'>{:g} s</text>", x,
           bottom + 15.0, time_s);
  }
}

void add_value_axis(std::string& svg, const Range& range) {
  const double step = nice_step(range.high - range.low, 4.0);
  for (double value = std::ceil(range.low / step) * step; value <= range.high + 1e-9;
       value += step) {
    const double y = kTop + kPlotHeight * (range.high - value) / (range.high - range.low);
    append(svg, "<line x1='{:.1f}' x2='{:.1f}' y1='{:.1f}' y2='{:.1f}' class='grid'/>", kLeft,
           kLeft + kPlotWidth, y, y);
    append(svg, "<text x='{:.1f}' y='{:.1f}' class='tick' text-anchor='end'>{:g}</text>",
           kLeft - 6.0, y + 4.0, std::abs(value) < 1e-12 ? 0.0 : value);
  }
}

/// A gap in time breaks the line.
void add_line(std::string& svg, const Series& series, const Range& range, double length_s) {
  std::string path;
  double previous_s = -1e9;
  for (const TimedValue& point : series.points) {
    if (!std::isfinite(point.value)) continue;
    const double x = kLeft + kPlotWidth * point.time_s / std::max(length_s, 0.1);
    const double y = kTop + kPlotHeight * (range.high - point.value) / (range.high - range.low);
    append(path, "{}{:.1f} {:.1f}", point.time_s - previous_s > kGap_s ? "M" : "L", x, y);
    previous_s = point.time_s;
  }
  append(svg, "<path d='{}' fill='none' stroke='{}' stroke-width='1.3'/>", path, series.color);
}

/// Scales the map frame into the picture.
struct MapScale {
  double west_m = 0.0;
  double north_m = 0.0;
  double px_per_m = 1.0;
  double x(double east_m) const { return (east_m - west_m) * px_per_m; }
  double y(double n_m) const { return (north_m - n_m) * px_per_m; }
};

struct Box {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300);
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-1e300);
  void cover(const Eigen::Vector2d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  bool is_empty() const { return low.x() > high.x(); }
};

void add_element(std::string& svg, const MapElement& element, const MapScale& scale,
                 const Box& box) {
  const bool near = std::ranges::any_of(element.points, [&](const Eigen::Vector2d& point) {
    return (point.array() >= box.low.array()).all() && (point.array() <= box.high.array()).all();
  });
  if (!near) return;
  constexpr std::array<std::string_view, 3> kClasses = {"divider", "crossing", "boundary"};
  append(svg, "<polyline class='{}' points='",
         kClasses[static_cast<size_t>(element.element_class)]);
  for (const Eigen::Vector2d& point : element.points) {
    append(svg, "{:.1f},{:.1f} ", scale.x(point.x()), scale.y(point.y()));
  }
  svg += "'/>";
}

void add_track(std::string& svg, const std::vector<PosedCycle>& cycles, const MapScale& scale) {
  for (size_t i = 1; i < cycles.size(); ++i) {
    if (cycles[i].time_s - cycles[i - 1].time_s > kGap_s) continue;
    const Se2& a = cycles[i - 1].map_from_vehicle;
    const Se2& b = cycles[i].map_from_vehicle;
    append(
        svg, "<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' stroke='{}' stroke-width='3'/>",
        scale.x(a.x_m), scale.y(a.y_m), scale.x(b.x_m), scale.y(b.y_m), color_of(cycles[i].state));
  }
}

void add_truth(std::string& svg, const Track& truth, const MapScale& scale) {
  if (truth.empty()) return;
  svg += "<path class='truth' d='";
  for (size_t i = 0; i < truth.size(); ++i) {
    const bool joined = i > 0 && to_seconds(truth[i].time - truth[i - 1].time) <= kGap_s;
    const Se2& pose = truth[i].map_from_vehicle;
    append(svg, "{}{:.1f} {:.1f}", joined ? "L" : "M", scale.x(pose.x_m), scale.y(pose.y_m));
  }
  svg += "'/>";
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '&':
        result += "&amp;";
        break;
      case '\'':
        result += "&#39;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string_view color_of(HealthState state) {
  switch (state) {
    case HealthState::kInit:
      return "#9aa0a6";
    case HealthState::kAcquiring:
      return "#4a7fd6";
    case HealthState::kTracking:
      return "#2e9d5b";
    case HealthState::kDegraded:
      return "#e0a100";
    case HealthState::kLost:
      return "#d23c3c";
    case HealthState::kFault:
      return "#9b2fae";
  }
  return "#000";
}

std::string line_chart(std::string_view title, std::string_view unit,
                       const std::vector<Series>& series, double length_s) {
  const Range range = range_of(series);
  std::string svg;
  append(svg,
         "<svg viewBox='0 0 {} {}' role='img' aria-label='{} over time'><text x='{}' y='16' "
         "class='title'>{} ({})</text>",
         kWidth, kTop + kPlotHeight + kBottom, escaped(title), kLeft, escaped(title),
         escaped(unit));
  add_value_axis(svg, range);
  add_time_axis(svg, length_s, kTop, kTop + kPlotHeight);
  double legend = kWidth - kRight;
  for (const Series& one : series) {
    add_line(svg, one, range, length_s);
    append(svg, "<text x='{:.1f}' y='16' text-anchor='end' class='tick' style='fill:{}'>{}</text>",
           legend, one.color, escaped(one.name));
    legend -= 12.0 + 7.0 * static_cast<double>(one.name.size());
  }
  return svg + "</svg>";
}

std::string state_bar(const std::vector<StatePeriod>& periods, double length_s) {
  constexpr double kHeight = 34.0;
  std::string svg;
  append(svg, "<svg viewBox='0 0 {} {}' role='img' aria-label='States over time'>", kWidth,
         kHeight + kBottom);
  for (const StatePeriod& period : periods) {
    const double begin = kPlotWidth * period.begin_s / std::max(length_s, 0.1);
    const double end = kPlotWidth * period.end_s / std::max(length_s, 0.1);
    append(svg,
           "<rect x='{:.2f}' y='4' width='{:.2f}' height='{}' fill='{}'><title>{} from {:.2f} s to "
           "{:.2f} s: {}</title></rect>",
           kLeft + begin, std::max(0.4, end - begin), kHeight - 8.0, color_of(period.state),
           to_string(period.state), period.begin_s, period.end_s, escaped(to_string(period.why)));
  }
  add_time_axis(svg, length_s, 4.0, kHeight - 4.0);
  return svg + "</svg>";
}

std::string track_map(const ReportData& data) {
  constexpr double kMargin_m = 25.0;
  constexpr double kMostHeight = 900.0;
  Box box;
  for (const PosedCycle& cycle : data.cycles) box.cover(cycle.map_from_vehicle.translation());
  for (const TrackPoint& point : data.truth) box.cover(point.map_from_vehicle.translation());
  if (box.is_empty()) return "<p>The recording has no pose.</p>";
  box.low.array() -= kMargin_m;
  box.high.array() += kMargin_m;
  const Eigen::Vector2d size = box.high - box.low;
  const MapScale scale{box.low.x(), box.high.y(),
                       std::min(kWidth / size.x(), kMostHeight / size.y())};
  std::string svg;
  append(svg,
         "<svg class='map' viewBox='0 0 {:.0f} {:.0f}' role='img' aria-label='Track on the map'>",
         size.x() * scale.px_per_m, size.y() * scale.px_per_m);
  if (data.map) {
    for (const MapElement& element : data.map->elements) add_element(svg, element, scale, box);
  }
  add_track(svg, data.cycles, scale);
  add_truth(svg, data.truth, scale);
  const double bar_m = nice_step(size.x(), 8.0);
  append(svg, "<line class='bar' x1='12' x2='{:.1f}' y1='14' y2='14'/>",
         12.0 + bar_m * scale.px_per_m);
  append(svg, "<text x='12' y='30' class='tick'>{:g} m</text>", bar_m);
  return svg + "</svg>";
}

}  // namespace bevloc::evaluation
