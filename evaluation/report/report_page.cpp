#include "evaluation/report/report_page.h"

#include <algorithm>
#include <cmath>

#include "common/base64.h"
#include "common/cameras.h"
#include "evaluation/drive/error_statistics.h"
#include "evaluation/report/charts.h"

namespace bevloc::evaluation {
namespace {

constexpr std::string_view kStyle = R"(
body{font:15px/1.45 system-ui,sans-serif;color:#1c1e21;background:#fff;max-width:1000px;
margin:0 auto;padding:16px}
h1{font-size:24px}h2{font-size:19px;margin-top:32px;border-bottom:1px solid #ddd}
table{border-collapse:collapse}td,th{padding:3px 12px 3px 0;text-align:left;vertical-align:top}
td:not(:last-child){white-space:nowrap}
svg{width:100%;height:auto;display:block;margin:6px 0}
svg.map{border:1px solid #ddd;background:#fafafa;max-height:80vh}
.grid{stroke:#e3e5e8;stroke-width:1}.tick{font-size:11px;fill:#5f6368}.title{font-size:13px}
.divider{fill:none;stroke:#b9c3d6;stroke-width:1}.crossing{fill:#e8dcc8;stroke:#c9b48e}
.boundary{fill:none;stroke:#8d99ae;stroke-width:1.4}
.truth{fill:none;stroke:#111;stroke-width:1;stroke-dasharray:4 3}
.bar{stroke:#333;stroke-width:3}
.pictures{display:grid;grid-template-columns:repeat(3,1fr);gap:4px}
.pictures img{width:100%;display:block}.pictures div{font-size:12px;color:#5f6368}
.answer{background:#f4f6fa;border-left:4px solid #4a7fd6;padding:8px 14px}
.state{display:inline-block;width:11px;height:11px;border-radius:2px;margin-right:5px})";

constexpr std::string_view kBlue = "#2f6fd0";
constexpr std::string_view kRed = "#c9372c";
constexpr std::string_view kGrey = "#7a828c";

Series series_of(const ReportData& data, std::string name, std::string_view color,
                 double (*value)(const PosedCycle&)) {
  Series series{std::move(name), color, {}};
  for (const PosedCycle& cycle : data.cycles) {
    if (claims_pose(cycle.state)) series.points.push_back({cycle.time_s, value(cycle)});
  }
  return series;
}

Series errors_of(const ReportData& data, std::string name, std::string_view color,
                 double (*value)(const Se2&)) {
  Series series{std::move(name), color, {}};
  for (const PosedCycle& cycle : data.cycles) {
    if (!claims_pose(cycle.state) || !cycle.error) continue;
    series.points.push_back({cycle.time_s, value(*cycle.error)});
  }
  return series;
}

Series matches_of(const ReportData& data, std::string name, std::string_view color,
                  double (*value)(const RecordedMatchResult&)) {
  Series series{std::move(name), color, {}};
  for (const RecordedMatchResult& match : data.matches) {
    if (match.evidence) series.points.push_back({match.time_s, value(match)});
  }
  return series;
}

double longitudinal(const Se2& error) {
  return error.x_m;
}
double lateral(const Se2& error) {
  return error.y_m;
}
double yaw_deg(const Se2& error) {
  return degrees(error.yaw_rad);
}

void add_table(std::string& page, const std::vector<std::pair<std::string, std::string>>& rows) {
  page += "<table>";
  for (const auto& [name, text] : rows) {
    append(page, "<tr><th>{}</th><td>{}</td></tr>", escaped(name), escaped(text));
  }
  page += "</table>";
}

void add_periods(std::string& page, const ReportData& data) {
  constexpr size_t kMost = 200;
  page += "<table><tr><th>from</th><th>for</th><th>state</th><th>with</th></tr>";
  for (size_t i = 0; i < std::min(kMost, data.periods.size()); ++i) {
    const StatePeriod& period = data.periods[i];
    const std::string why = to_string(period.why);
    append(page,
           "<tr><td>{} ({:.1f} s)</td><td>{:.2f} s</td><td><span class='state' "
           "style='background:{}'></span>{}</td><td>{}</td></tr>",
           time_of_day(data, period.begin_s), period.begin_s, period.end_s - period.begin_s,
           color_of(period.state), to_string(period.state), why.empty() ? "-" : escaped(why));
  }
  page += "</table>";
  if (data.periods.size() > kMost) {
    append(page, "<p>{} more changes are not listed.</p>", data.periods.size() - kMost);
  }
}

void add_accuracy(std::string& page, const ReportData& data) {
  if (!data.truth.empty()) {
    page += "<h2>Errors against the truth</h2>";
    page += line_chart("position", "m",
                       {errors_of(data, "longitudinal", kBlue, longitudinal),
                        errors_of(data, "lateral", kRed, lateral)},
                       data.length_s);
    page += line_chart("yaw", "deg", {errors_of(data, "yaw", kGrey, yaw_deg)}, data.length_s);
  } else {
    page +=
        "<h2>Consistency</h2><p>The recording has no truth. Corrections of the matches against "
        "the predicted pose show how well odometry, GNSS and map agree.</p>";
    page += line_chart(
        "correction", "m",
        {matches_of(data, "longitudinal", kBlue,
                    [](const RecordedMatchResult& match) { return match.correction.x_m; }),
         matches_of(data, "lateral", kRed,
                    [](const RecordedMatchResult& match) { return match.correction.y_m; })},
        data.length_s);
    page += line_chart("correction in its own standard deviations", "sigma",
                       {matches_of(data, "lateral", kRed,
                                   [](const RecordedMatchResult& match) {
                                     return match.correction.y_m / std::max(match.sigma[1], 1e-6);
                                   })},
                       data.length_s);
  }
  page += line_chart(
      "uncertainty of valid poses", "m",
      {series_of(data, "sigma", kGrey, [](const PosedCycle& cycle) { return cycle.sigma_m; }),
       series_of(data, "longitudinal protection level", kBlue,
                 [](const PosedCycle& cycle) { return cycle.protection_longitudinal_m; }),
       series_of(data, "lateral protection level", kRed,
                 [](const PosedCycle& cycle) { return cycle.protection_lateral_m; })},
      data.length_s);
  page += line_chart("score of the matches", "1 is a perfect overlap",
                     {matches_of(data, "score", kBlue,
                                 [](const RecordedMatchResult& match) { return match.score; })},
                     data.length_s);
}

void add_drops(std::string& page, const ReportData& data) {
  page += "<h2>Latency and drops</h2>";
  page += line_chart("from exposure to the first pose that uses the frameset", "ms",
                     {{"latency", kBlue, data.latency_ms}}, data.length_s);
  if (!data.counters) return;
  const bevloc::recording::Counters& counters = *data.counters;
  const auto number = [](uint64_t value) { return std::to_string(value); };
  page += "<p>Totals from the start of the appliance to the end of the recording:</p>";
  add_table(page, {{"camera frames captured", number(counters.frames_captured())},
                   {"used", number(counters.frames_used())},
                   {"lost before capture", number(counters.frames_missed())},
                   {"dropped for newer ones", number(counters.frames_displaced())},
                   {"without a frameset", number(counters.frames_mismatched())},
                   {"in a skipped frameset", number(counters.frames_skipped())},
                   {"CAN frames sent", number(counters.bus_sent())},
                   {"CAN frames received", number(counters.bus_received())},
                   {"CAN frames lost", number(counters.bus_lost())},
                   {"images not recorded", number(counters.images_not_recorded())},
                   {"events not recorded", number(counters.events_not_recorded())}});
}

void add_frames(std::string& page, const ReportData& data, const std::vector<ShownFrame>& frames) {
  if (frames.empty()) return;
  page += "<h2>Worst frames</h2>";
  for (const ShownFrame& frame : frames) {
    append(page, "<h3>{} ({:.1f} s)</h3><p>{}</p><div class='pictures'>",
           time_of_day(data, frame.time_s), frame.time_s, escaped(frame.why));
    for (int camera = 0; camera < kCameraCount; ++camera) {
      append(page, "<div>{}", kCameraNames[camera]);
      if (!frame.pictures[camera].empty()) {
        append(page, "<img alt='{}' src='data:image/jpeg;base64,{}'>", kCameraNames[camera],
               base64(frame.pictures[camera]));
      } else if (frame.unreadable[camera]) {
        page += "<p>no readable picture</p>";
      }
      page += "</div>";
    }
    page += "</div>";
  }
}

std::string mean_and_quantile(std::vector<double> values, std::string_view unit) {
  if (values.empty()) return "none";
  double mean = 0.0;
  for (double& value : values) mean += value = std::abs(value);
  mean /= static_cast<double>(values.size());
  return fmt::format("mean {:.2f} {}, 95 % below {:.2f} {}", mean, unit, quantile_of(values, 0.95),
                     unit);
}

void add_figures_of_errors(const ReportData& data,
                           std::vector<std::pair<std::string, std::string>>& figures) {
  std::array<std::vector<double>, 3> errors;
  for (const PosedCycle& cycle : data.cycles) {
    if (!claims_pose(cycle.state) || !cycle.error) continue;
    errors[0].push_back(cycle.error->x_m);
    errors[1].push_back(cycle.error->y_m);
    errors[2].push_back(degrees(cycle.error->yaw_rad));
  }
  figures.emplace_back("longitudinal error", mean_and_quantile(errors[0], "m"));
  figures.emplace_back("lateral error", mean_and_quantile(errors[1], "m"));
  figures.emplace_back("yaw error", mean_and_quantile(errors[2], "deg"));
}

}  // namespace

std::vector<std::pair<std::string, std::string>> key_figures(const ReportData& data) {
  std::vector<std::pair<std::string, std::string>> figures;
  std::vector<double> latencies;
  for (const TimedValue& latency : data.latency_ms) latencies.push_back(latency.value);
  double valid_s = 0.0;
  double recorded_s = 0.0;
  for (const StatePeriod& period : data.periods) {
    recorded_s += period.end_s - period.begin_s;
    if (claims_pose(period.state)) valid_s += period.end_s - period.begin_s;
  }
  figures.emplace_back("valid poses", fmt::format("{:.1f} s of {:.1f} s", valid_s, recorded_s));
  if (!data.truth.empty()) {
    add_figures_of_errors(data, figures);
  } else {
    std::vector<double> lateral_m;
    for (const RecordedMatchResult& match : data.matches) {
      if (match.evidence) lateral_m.push_back(match.correction.y_m);
    }
    figures.emplace_back("lateral correction", mean_and_quantile(lateral_m, "m"));
  }
  figures.emplace_back("latency", mean_and_quantile(latencies, "ms"));
  return figures;
}

std::vector<ShownFrame> choose_frames(const ReportData& data) {
  struct Candidate {
    double badness = 0.0;
    ShownFrame frame;
  };
  std::vector<Candidate> candidates;
  for (const PosedCycle& cycle : data.cycles) {
    if (!claims_pose(cycle.state) || !cycle.error) continue;
    const double error_m = cycle.error->translation().norm();
    candidates.push_back(
        {error_m, {cycle.time_s, fmt::format("The error was {:.2f} m.", error_m), {}}});
  }
  for (const RecordedMatchResult& match : data.matches) {
    if (!data.truth.empty()) break;
    candidates.push_back(
        {1.0 - match.score,
         {match.time_s, fmt::format("The match had a score of {:.2f}.", match.score), {}}});
  }
  std::ranges::stable_sort(candidates, std::greater<>(), &Candidate::badness);
  constexpr size_t kMost = 3;
  constexpr double kApart_s = 2.0;
  std::vector<ShownFrame> chosen;
  for (const Candidate& candidate : candidates) {
    if (chosen.size() == kMost) break;
    const bool near = std::ranges::any_of(chosen, [&](const ShownFrame& other) {
      return std::abs(other.time_s - candidate.frame.time_s) < kApart_s;
    });
    if (!near) chosen.push_back(candidate.frame);
  }
  return chosen;
}

std::string report_page(const ReportData& data, const std::vector<std::string>& names,
                        const std::vector<std::pair<std::string, std::string>>& facts,
                        const std::vector<ShownFrame>& frames, const std::vector<Answer>& answers) {
  std::string page;
  append(
      page,
      "<!doctype html><html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
      "content='width=device-width,initial-scale=1'><title>bevloc report</title><style>{}</style>"
      "</head><body><h1>Report of a drive</h1>",
      kStyle);
  std::vector<std::pair<std::string, std::string>> head{
      {"recorded",
       fmt::format("{} to {} (local time of this machine), {:.1f} s", time_of_day(data, 0.0),
                   time_of_day(data, data.length_s), data.length_s)}};
  for (const std::string& name : names) head.emplace_back("file", name);
  head.insert(head.end(), facts.begin(), facts.end());
  const auto figures = key_figures(data);
  head.insert(head.end(), figures.begin(), figures.end());
  add_table(page, head);
  for (const Answer& answer : answers) {
    append(page, "<h2>{}</h2><div class='answer'><ul>", escaped(answer.question));
    for (const std::string& sentence : answer.sentences)
      append(page, "<li>{}</li>", escaped(sentence));
    page += "</ul></div>";
  }
  page +=
      "<h2>Track</h2><p>The colour is the state (see below); the dashed line is the truth where "
      "it is known; north is up.</p>";
  page += track_map(data);
  page += "<h2>States</h2>" + state_bar(data.periods, data.length_s);
  add_periods(page, data);
  add_accuracy(page, data);
  add_drops(page, data);
  add_frames(page, data, frames);
  return page + "</body></html>\n";
}

}  // namespace bevloc::evaluation
