#include "firmware/stages/gnss_stage.h"

#include <algorithm>
#include <cmath>

namespace bevloc::firmware {
namespace {

/// The assumed speed if the receiver does not report one.
constexpr double kUnknownSpeed_mps = 40.0;
constexpr double kCourseIsHeading_mps = 5.0;
constexpr double kCourseSigma_deg = 3.0;
/// A common lateral acceleration in bends. There the course of an antenna in front of the rear axle
/// differs from the heading.
constexpr double kAcross_mps2 = 2.0;

/// Returns the heading that follows from the course of the antenna. Its sigma allows for the
/// difference from the course of the rear axle.
std::optional<can::GeodeticFix::Heading> heading_of(const drivers::GnssFix& fix,
                                                    const GnssSample::Antenna& antenna) {
  if (!fix.course_deg || !fix.speed_mps || *fix.speed_mps < kCourseIsHeading_mps) {
    return std::nullopt;
  }
  const double speed_mps = *fix.speed_mps;
  const double turned_rad = std::abs(antenna.x_m) * kAcross_mps2 / (speed_mps * speed_mps);
  return can::GeodeticFix::Heading{
      *fix.course_deg,
      std::hypot(std::max(kCourseSigma_deg, fix.sigma_course_deg), degrees(turned_rad))};
}

}  // namespace

GnssSample gnss_sample_of(const drivers::GnssFix& fix, const drivers::FixTime& time,
                          const GnssConfig& config, can::GeoReference& geo) {
  const double travelled_m = fix.speed_mps.value_or(kUnknownSpeed_mps) * to_seconds(time.sigma);
  const auto sigma_of = [&](double sigma_m) {
    return std::hypot(std::max(sigma_m, config.min_sigma_m), travelled_m);
  };
  GnssSample sample = can::gnss_sample_of({.position = {fix.latitude_deg, fix.longitude_deg},
                                           .sigma_north_m = sigma_of(fix.sigma_north_m),
                                           .sigma_east_m = sigma_of(fix.sigma_east_m),
                                           .heading = heading_of(fix, config.antenna)},
                                          geo, time.time);
  sample.antenna = config.antenna;
  return sample;
}

GnssStage::GnssStage(const GnssConfig& config, can::GeodeticPosition map_origin,
                     const drivers::Clock& clock, VehicleQueue& samples, ReadWall read_wall)
    : config_(config),
      geo_(map_origin),
      clock_(clock),
      samples_(samples),
      read_wall_(read_wall),
      client_(config.gpsd),
      fix_clock_(config.clock) {}

void GnssStage::step(Duration timeout) {
  client_.wait(clock_.now(), timeout);
  const drivers::FixArrival arrival{clock_.now(), clock_.unsteered(), read_wall_()};
  while (const auto fix = client_.take_fix()) judge(*fix, arrival);
  counters_.gpsd = client_.counters();
  counters_.connected = client_.is_connected();
  counters_.max_age = fix_clock_.max_usable_age();
  published_.store(counters_);
}

void GnssStage::judge(const drivers::GnssFix& fix, const drivers::FixArrival& arrival) {
  const drivers::FixTime time = fix_clock_.judge(fix.utc, arrival);
  ++counters_.fixes[static_cast<size_t>(time.verdict)];
  if (time.verdict != drivers::FixVerdict::kUsable) return;
  if (observer_) observer_(fix, time);
  take(fix, time);
}

void GnssStage::take(const drivers::GnssFix& fix, const drivers::FixTime& time) {
  ++counters_.samples;
  samples_.push(gnss_sample_of(fix, time, config_, geo_));
  published_.store(counters_);
}

}  // namespace bevloc::firmware
