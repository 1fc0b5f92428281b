// Reads the reports of gpsd: JSON objects, one a line (gpsd_json(5)).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace bevloc::drivers {

/// A position of a receiver's antenna. Each sigma is one standard deviation.
struct GnssFix {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double sigma_north_m = 0.0;
  double sigma_east_m = 0.0;
  std::optional<double> speed_mps{};   ///< over ground
  std::optional<double> course_deg{};  ///< over ground, clockwise from true north, in [0, 360)
  double sigma_course_deg = 0.0;       ///< 0 if the receiver does not say
  std::chrono::nanoseconds utc{};      ///< the moment of the position, as the time since 1970
};

/// Whether a receiver can report these values, which may be those of a damaged file.
bool is_possible(const GnssFix& fix);

/// The kind of one line.
enum class GpsdLine : uint8_t {
  kFix,
  kAccuracy,       ///< standard deviations of the next fixes (GST)
  kOther,          ///< a report of another kind, such as SKY or VERSION
  kNoFix,          ///< a position report without a position (mode below 2)
  kNoAccuracy,     ///< a position without eph or epx and epy, so nobody knows how good it is
  kNoTime,         ///< a position without a time, so nobody knows how old it is
  kNotSatellites,  ///< dead reckoning or a simulation by the receiver
  kOutOfRange,     ///< a value that no receiver can have
  kNotReadable,    ///< not a JSON object with a class
};
inline constexpr size_t kGpsdLines = 9;

struct GpsdReport {
  GpsdLine line = GpsdLine::kOther;
  GnssFix fix{};  ///< valid for kFix only
};

/// Reads the lines of one gpsd in their order.
///
/// The sigma of a fix comes from the receiver's own accuracy report (GST), if three things hold:
/// the latest GST is from the same receiver, it is at most 1.5 s older than the fix, and mode and
/// status have not changed since. Otherwise, eph of the position report (TPV) divided by the square
/// root of 2 is the sigma of each axis. Without eph, the sigmas are epx and epy. eph comes first,
/// because with UBX it is the receiver's own accuracy, and epx and epy are guesses of gpsd. This is
/// cautious: gpsd does not state the confidence level, and many receivers give the bound of 95 %.
/// If the receiver states no accuracy, gpsd estimates it from the dilution of precision. One
/// thread.
class GpsdReader {
 public:
  GpsdReport read(std::string_view line);

 private:
  struct Accuracy {
    std::string receiver;
    std::chrono::nanoseconds utc{};
    double sigma_north_m = 0.0;
    double sigma_east_m = 0.0;
  };
  struct Quality {
    double mode = 0.0;
    double status = 0.0;
    bool operator==(const Quality&) const = default;
  };

  void use_accuracy(const Quality& quality, GnssFix& fix);

  std::optional<Accuracy> accuracy_;
  Quality quality_;  ///< quality of the latest position report
};

/// Returns a text such as "2026-11-23T22:23:04.125Z" as the time since 1970, or nothing for any
/// other text.
std::optional<std::chrono::nanoseconds> utc_of(std::string_view text);

}  // namespace bevloc::drivers
