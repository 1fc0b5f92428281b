#include "evaluation/report/report_data.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <optional>

#include <Eigen/Eigenvalues>

#include "evaluation/drive/error_statistics.h"
#include "firmware/recording/topics.h"

namespace bevloc::evaluation {
namespace {

constexpr double kSecond_ns = 1e9;

double seconds_since(const ReportData& data, uint64_t log_time_ns) {
  return static_cast<double>(static_cast<int64_t>(log_time_ns - data.begin_ns)) / kSecond_ns;
}

double worst_sigma_m(const bevloc::recording::Solution& solution) {
  if (solution.covariance_size() != 9) return 0.0;
  Eigen::Matrix2d covariance;
  covariance << solution.covariance(0), solution.covariance(1), solution.covariance(3),
      solution.covariance(4);
  if (!covariance.allFinite()) return 0.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(covariance);
  return std::sqrt(std::max(0.0, solver.eigenvalues()(1)));
}

void note_state(const bevloc::recording::Solution& solution, double time_s,
                std::vector<StatePeriod>& periods) {
  const auto state = static_cast<HealthState>(std::min<uint32_t>(solution.state(), 5));
  const WhyMask why = WhyMask::from_bits(solution.why());
  constexpr double kLongestCycle_s = static_cast<double>(Recording::kLongestCycle_ns) / kSecond_ns;
  const bool follows = !periods.empty() && time_s - periods.back().end_s <= kLongestCycle_s;
  if (follows) periods.back().end_s = time_s;
  const bool same = follows && periods.back().state == state && periods.back().why == why;
  if (!same) periods.push_back({time_s, time_s, state, why});
}

void note_cycle(const bevloc::recording::Solution& solution, Time time, double time_s,
                ReportData& data) {
  constexpr double kPeriod_s = 0.0999;
  if (!solution.pose_known()) return;
  if (!data.cycles.empty() && time_s - data.cycles.back().time_s < kPeriod_s) return;
  PosedCycle cycle;
  cycle.time_s = time_s;
  cycle.state = static_cast<HealthState>(std::min<uint32_t>(solution.state(), 5));
  cycle.map_from_vehicle = firmware::se2_of(solution.map_from_vehicle());
  cycle.sigma_m = worst_sigma_m(solution);
  cycle.protection_longitudinal_m = solution.protection_longitudinal_m();
  cycle.protection_lateral_m = solution.protection_lateral_m();
  if (const auto truth = pose_at(data.truth, time)) {
    cycle.error = pose_error(*truth, cycle.map_from_vehicle);
  }
  data.cycles.push_back(cycle);
}

Status read_solutions(Recording& recording, ReportData& data) {
  // The frameset of the first solution may have been answered before the recording begins.
  std::optional<uint64_t> capture_ns;
  for (const MessagePlace& place : recording.messages(firmware::kSolutionTopic)) {
    const auto solution = recording.read<bevloc::recording::Solution>(place);
    if (!solution) return tl::unexpected(solution.error());
    const double time_s = seconds_since(data, place.log_time_ns);
    const Time time = recording.clock_time(place.log_time_ns);
    note_state(*solution, time_s, data.periods);
    note_cycle(*solution, time, time_s, data);
    const bool is_new = capture_ns && solution->capture_clock_ns() != *capture_ns;
    if (is_new && solution->capture_clock_ns() != 0) {
      const Duration latency =
          time - Time(Duration(static_cast<int64_t>(solution->capture_clock_ns())));
      data.latency_ms.push_back({time_s, to_milliseconds(latency)});
    }
    capture_ns = solution->capture_clock_ns();
  }
  return {};
}

Status read_matches(Recording& recording, ReportData& data) {
  for (const MessagePlace& place : recording.messages(firmware::kMatchTopic)) {
    const auto match = recording.read<bevloc::recording::Match>(place);
    if (!match) return tl::unexpected(match.error());
    RecordedMatchResult result;
    result.time_s = seconds_since(data, place.log_time_ns);
    result.frame_time = Time(Duration(static_cast<int64_t>(match->frameset_clock_ns())));
    result.evidence = match->evidence();
    result.score = match->score();
    result.correction = firmware::se2_of(match->correction());
    for (int axis = 0; axis < 3 && match->covariance_size() == 9; ++axis) {
      result.sigma[axis] = std::sqrt(std::max(0.0, match->covariance(4 * axis)));
    }
    result.cameras = match->cameras();
    data.matches.push_back(result);
  }
  return {};
}

std::vector<double> times_of(const Recording& recording, std::string_view topic,
                             const ReportData& data) {
  std::vector<double> times;
  for (const MessagePlace& place : recording.messages(topic)) {
    times.push_back(seconds_since(data, place.log_time_ns));
  }
  return times;
}

std::tm local_time(uint64_t log_time_ns) {
  const auto seconds = static_cast<time_t>(log_time_ns / 1'000'000'000U);
  std::tm local{};
  localtime_r(&seconds, &local);
  return local;
}

double second_of_day(const ReportData& data) {
  const std::tm local = local_time(data.begin_ns);
  return 3600.0 * local.tm_hour + 60.0 * local.tm_min + local.tm_sec +
         static_cast<double>(data.begin_ns % 1'000'000'000U) / kSecond_ns;
}

bool is_bad(HealthState state) {
  return state == HealthState::kLost || state == HealthState::kFault;
}

}  // namespace

Result<ReportData> read_report_data(Recording& recording) {
  ReportData data;
  data.begin_ns = recording.begin_ns();
  data.length_s = seconds_since(data, recording.end_ns());
  auto truth = read_track(recording, firmware::kTruthTopic);
  if (!truth) return tl::unexpected(truth.error());
  data.truth = std::move(*truth);
  if (Status read = read_solutions(recording, data); !read) return tl::unexpected(read.error());
  if (Status read = read_matches(recording, data); !read) return tl::unexpected(read.error());
  data.bus_in_s = times_of(recording, firmware::kBusInTopic, data);
  for (int camera = 0; camera < kCameraCount; ++camera) {
    data.images_s[camera] = times_of(recording, firmware::image_topic(camera), data);
  }
  const auto& counters = recording.messages(firmware::kCountersTopic);
  if (!counters.empty()) {
    auto last = recording.read<bevloc::recording::Counters>(counters.back());
    if (!last) return tl::unexpected(last.error());
    data.counters = std::move(*last);
  }
  auto map = recording.map();
  if (!map) return tl::unexpected(map.error());
  data.map = std::move(*map);
  return data;
}

std::string time_of_day(const ReportData& data, double time_s) {
  const auto time_ns = data.begin_ns + static_cast<uint64_t>(std::max(0.0, time_s) * kSecond_ns);
  const std::tm local = local_time(time_ns);
  return fmt::format("{:02}:{:02}:{:02}.{}", local.tm_hour, local.tm_min, local.tm_sec,
                     time_ns % 1'000'000'000U / 100'000'000U);
}

namespace {

struct DayTime {
  double second_of_day = 0.0;
  bool whole_minute = false;  ///< no second was named
};

/// Reads "14:32" or "14:32:05".
std::optional<DayTime> parse_day_time(const std::string& text) {
  int hour = 0;
  int minute = 0;
  double second = 0.0;
  int to_minute = 0;
  int to_second = 0;
  const int parts =
      std::sscanf(text.c_str(), "%2d:%2d%n:%lf%n", &hour, &minute, &to_minute, &second, &to_second);
  const int end = parts == 3 ? to_second : to_minute;
  const bool complete = parts >= 2 && static_cast<size_t>(end) == text.size();
  const bool in_day =
      hour >= 0 && hour < 24 && minute >= 0 && minute < 60 && second >= 0.0 && second < 60.0;
  if (!complete || !in_day) return std::nullopt;
  return DayTime{3600.0 * hour + 60.0 * minute + second, parts == 2};
}

}  // namespace

Result<double> parse_moment(const ReportData& data, const std::string& text) {
  char surplus = 0;
  const auto refuse = [&text] {
    return fail(
        "--at: found '{}', wanted a time of day such as 14:32 or 14:32:05, or seconds such as 12.5",
        text);
  };
  const auto day_time = parse_day_time(text);
  const bool whole_minute = day_time && day_time->whole_minute;
  double moment_s = 0.0;
  if (day_time) {
    constexpr double kDay_s = 86400.0;
    moment_s = day_time->second_of_day - second_of_day(data);
    // A minute that began before the recording may be meant. An earlier time is one after midnight.
    if (moment_s < -60.0) moment_s += kDay_s;
  } else if (std::sscanf(text.c_str(), "%lf%c", &moment_s, &surplus) != 1) {
    return refuse();
  }
  if (!std::isfinite(moment_s)) return refuse();
  const double last_s = whole_minute ? moment_s + 60.0 : moment_s;
  if (last_s < 0.0 || moment_s > data.length_s) {
    return fail("--at: found {}, wanted a time within the recording, {} to {}", text,
                time_of_day(data, 0.0), time_of_day(data, data.length_s));
  }
  // The first state comes a little after the first message.
  const double first_s = data.periods.empty() ? 0.0 : data.periods.front().begin_s;
  if (!whole_minute) return std::max(moment_s, first_s);
  for (const StatePeriod& period : data.periods) {
    const bool inside = period.end_s >= moment_s && period.begin_s < last_s;
    if (inside && is_bad(period.state)) return std::max({period.begin_s, moment_s, 0.0});
  }
  return std::max(moment_s, first_s);
}

namespace {

size_t count_between(const std::vector<double>& times, double begin_s, double end_s) {
  return static_cast<size_t>(std::ranges::lower_bound(times, end_s) -
                             std::ranges::lower_bound(times, begin_s));
}

void explain_matches(const ReportData& data, double begin_s, double end_s,
                     std::vector<std::string>& sentences) {
  size_t count = 0;
  size_t without = 0;
  double score = 0.0;
  for (const RecordedMatchResult& match : data.matches) {
    if (match.time_s < begin_s || match.time_s >= end_s) continue;
    ++count;
    without += match.evidence ? 0 : 1;
    score += match.score;
  }
  if (count == 0) {
    sentences.push_back("No frameset was matched with the map.");
    return;
  }
  sentences.push_back(fmt::format(
      "{} framesets were matched with a mean score of {:.2f} (1 is a perfect overlap); {} of them "
      "had nothing to match.",
      count, score / static_cast<double>(count), without));
}

void explain_inputs(const ReportData& data, double begin_s, double end_s,
                    std::vector<std::string>& sentences) {
  sentences.push_back(fmt::format("{} frames came from the CAN bus.",
                                  count_between(data.bus_in_s, begin_s, end_s)));
  std::string cameras;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    fmt::format_to(std::back_inserter(cameras), "{}{} {}", camera == 0 ? "" : ", ",
                   kCameraNames[camera], count_between(data.images_s[camera], begin_s, end_s));
  }
  sentences.push_back("Images per camera: " + cameras + ".");
}

/// Whether nothing is missing between a period and the one before.
bool follows(const std::vector<StatePeriod>& periods, size_t index) {
  return index > 0 && periods[index - 1].end_s == periods[index].begin_s;
}

/// The first period of the state that holds at `index`.
size_t begin_of_state(const std::vector<StatePeriod>& periods, size_t index) {
  while (follows(periods, index) && periods[index - 1].state == periods[index].state) --index;
  return index;
}

}  // namespace

std::vector<std::string> explain(const ReportData& data, double time_s) {
  std::vector<std::string> sentences;
  const auto& periods = data.periods;
  const auto behind = std::ranges::find_if(
      periods, [time_s](const StatePeriod& period) { return period.begin_s > time_s; });
  if (behind == periods.begin()) {
    sentences.push_back("The recording has no state before this time.");
    return sentences;
  }
  const auto index = static_cast<size_t>(std::prev(behind) - periods.begin());
  const bool is_last = behind == periods.end();
  if (!is_last && time_s > periods[index].end_s && !follows(periods, index + 1)) {
    sentences.push_back(fmt::format("Nothing is recorded from {} to {}.",
                                    time_of_day(data, periods[index].end_s),
                                    time_of_day(data, periods[index + 1].begin_s)));
    return sentences;
  }
  const size_t first = begin_of_state(periods, index);
  const StatePeriod& now = periods[index];
  const StatePeriod& began = periods[first];
  const auto reasons = [](WhyMask why) {
    const std::string text = to_string(why);
    return text.empty() ? std::string("none") : text;
  };
  sentences.push_back(fmt::format("At {} the state was {}, since {}. Reasons: {}.",
                                  time_of_day(data, time_s), to_string(now.state),
                                  time_of_day(data, began.begin_s), reasons(now.why)));
  if (first != index) {
    sentences.push_back(fmt::format("Reasons at its beginning: {}.", reasons(began.why)));
  }
  if (first > 0 && !follows(periods, first)) {
    sentences.push_back("Nothing is recorded of the time before that.");
  } else if (first > 0) {
    const StatePeriod& before = periods[first - 1];
    const double since_s = periods[begin_of_state(periods, first - 1)].begin_s;
    sentences.push_back(fmt::format("Before that it was {} for {:.1f} s. Reasons at its end: {}.",
                                    to_string(before.state), before.end_s - since_s,
                                    reasons(before.why)));
  }
  constexpr double kBefore_s = 5.0;
  const double begin_s = std::max(0.0, began.begin_s - kBefore_s);
  sentences.push_back(fmt::format("In the {:.1f} s before {}:", began.begin_s - begin_s,
                                  time_of_day(data, began.begin_s)));
  explain_matches(data, begin_s, began.begin_s, sentences);
  explain_inputs(data, begin_s, began.begin_s, sentences);
  return sentences;
}

}  // namespace bevloc::evaluation
