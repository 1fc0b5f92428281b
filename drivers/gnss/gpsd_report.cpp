#include "drivers/gnss/gpsd_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <nlohmann/json.hpp>

#include "common/geodetic.h"

namespace bevloc::drivers {
namespace {

using Json = nlohmann::json;

constexpr double kMostSigma_m = 1000.0;
constexpr double kMostSpeed_mps = 150.0;
constexpr std::chrono::milliseconds kAccuracyLifetime{1500};
/// Values of `status` (gps.h of gpsd 3.22).
constexpr double kDeadReckoning = 5.0;
constexpr double kSimulated = 8.0;

/// Returns a number of the report, or nothing if it has none of this name.
std::optional<double> number(const Json& report, const char* name) {
  const auto found = report.find(name);
  if (found == report.end() || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// Returns false if the report has no accuracy.
bool read_sigma(const Json& report, GnssFix& fix) {
  const auto east = number(report, "epx");
  const auto north = number(report, "epy");
  const auto both = number(report, "eph");
  if (!(east && north) && !both) return false;
  // eph is the horizontal error. Its north and east parts count as equal. A receiver of u-blox
  // (UBX) states no other error: gpsd then still adds epx and epy, which it guesses.
  const double part_m = both.value_or(0.0) / std::sqrt(2.0);
  fix.sigma_east_m = both ? part_m : *east;
  fix.sigma_north_m = both ? part_m : *north;
  return true;
}

void read_motion(const Json& report, GnssFix& fix) {
  fix.speed_mps = number(report, "speed");
  const auto course_deg = number(report, "track");
  if (!course_deg || *course_deg < 0.0 || *course_deg > 360.0) return;
  fix.course_deg = std::fmod(*course_deg, 360.0);
  fix.sigma_course_deg = std::max(0.0, number(report, "epd").value_or(0.0));
}

std::optional<std::chrono::nanoseconds> read_time(const Json& report) {
  const auto time = report.find("time");
  const bool has_time = time != report.end() && time->is_string();
  return has_time ? utc_of(time->get<std::string>()) : std::nullopt;
}

/// Returns the device that the receiver is connected to, or an empty text if the report does not
/// name it.
std::string receiver_of(const Json& report) {
  const auto device = report.find("device");
  return device != report.end() && device->is_string() ? device->get<std::string>() : "";
}

GpsdReport read_position(const Json& report) {
  const auto mode = number(report, "mode");
  const auto latitude_deg = number(report, "lat");
  const auto longitude_deg = number(report, "lon");
  if (!mode || *mode < 2.0 || !latitude_deg || !longitude_deg) return {GpsdLine::kNoFix};
  const double status = number(report, "status").value_or(0.0);
  if (status == kDeadReckoning || status == kSimulated) return {GpsdLine::kNotSatellites};
  GpsdReport read{GpsdLine::kFix};
  GnssFix& fix = read.fix;
  fix.latitude_deg = *latitude_deg;
  fix.longitude_deg = *longitude_deg;
  if (!read_sigma(report, fix)) return {GpsdLine::kNoAccuracy};
  read_motion(report, fix);
  if (!is_possible(fix)) return {GpsdLine::kOutOfRange};
  const auto utc = read_time(report);
  if (!utc) return {GpsdLine::kNoTime};
  fix.utc = *utc;
  return read;
}

}  // namespace

bool is_possible(const GnssFix& fix) {
  const auto is_sigma = [](double sigma_m) { return sigma_m >= 0.0 && sigma_m < kMostSigma_m; };
  const double speed_mps = fix.speed_mps.value_or(0.0);
  const double course_deg = fix.course_deg.value_or(0.0);
  return is_on_earth(fix.latitude_deg, fix.longitude_deg) && is_sigma(fix.sigma_east_m) &&
         is_sigma(fix.sigma_north_m) && speed_mps >= 0.0 && speed_mps < kMostSpeed_mps &&
         course_deg >= 0.0 && course_deg < 360.0 && fix.sigma_course_deg >= 0.0;
}

std::optional<std::chrono::nanoseconds> utc_of(std::string_view text) {
  int year = 0;
  unsigned month = 0;
  unsigned day = 0;
  unsigned hour = 0;
  unsigned minute = 0;
  double second = 0.0;
  int length = 0;
  const std::string copy(text);
  const int read = std::sscanf(copy.c_str(), "%4d-%2u-%2uT%2u:%2u:%lfZ%n", &year, &month, &day,
                               &hour, &minute, &second, &length);
  const bool is_plain = copy.find_first_not_of("0123456789-T:.Z") == std::string::npos;
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month),
                                         std::chrono::day(day)};
  const bool valid = read == 6 && is_plain && static_cast<size_t>(length) == copy.size() &&
                     date.ok() && year >= 1970 && year < 2200 && hour < 24 && minute < 60 &&
                     second >= 0.0 && second < 61.0;
  if (!valid) return std::nullopt;
  return std::chrono::sys_days(date).time_since_epoch() + std::chrono::hours(hour) +
         std::chrono::minutes(minute) +
         std::chrono::nanoseconds(static_cast<int64_t>(std::llround(second * 1e9)));
}

GpsdReport GpsdReader::read(std::string_view line) {
  const Json report = Json::parse(line, nullptr, false);
  if (!report.is_object()) return {GpsdLine::kNotReadable};
  const auto kind = report.find("class");
  if (kind == report.end() || !kind->is_string()) return {GpsdLine::kNotReadable};
  if (*kind == "GST") {
    const auto utc = read_time(report);
    const auto north = number(report, "lat");
    const auto east = number(report, "lon");
    accuracy_.reset();
    const std::string receiver = receiver_of(report);
    const auto is_sigma = [](const std::optional<double>& sigma_m) {
      return sigma_m && *sigma_m > 0.0 && *sigma_m < kMostSigma_m;
    };
    if (utc && is_sigma(north) && is_sigma(east)) {
      accuracy_ = Accuracy{receiver, *utc, *north, *east};
    }
    return {GpsdLine::kAccuracy};
  }
  if (*kind != "TPV") return {GpsdLine::kOther};
  GpsdReport read = read_position(report);
  const Quality quality{number(report, "mode").value_or(0.0),
                        number(report, "status").value_or(0.0)};
  if (accuracy_ && accuracy_->receiver != receiver_of(report)) accuracy_.reset();
  use_accuracy(quality, read.fix);
  return read;
}

void GpsdReader::use_accuracy(const Quality& quality, GnssFix& fix) {
  if (!(quality == quality_)) accuracy_.reset();
  quality_ = quality;
  if (!accuracy_ || fix.utc < accuracy_->utc || fix.utc - accuracy_->utc > kAccuracyLifetime) {
    return;
  }
  fix.sigma_north_m = accuracy_->sigma_north_m;
  fix.sigma_east_m = accuracy_->sigma_east_m;
}

}  // namespace bevloc::drivers
