// GNSS: the lines of gpsd.
#include <algorithm>
#include <cmath>
#include <string_view>

#include "drivers/gnss/gpsd_report.h"
#include "tests/fuzz/targets.h"

namespace bevloc::fuzz {

/// Every accepted fix has values that a receiver can have.
void run_gpsd(Bytes bytes) {
  drivers::GpsdReader reader;
  std::string_view text = text_of(bytes);
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    const drivers::GpsdReport report = reader.read(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (report.line != drivers::GpsdLine::kFix) continue;
    const drivers::GnssFix& fix = report.fix;
    expect(std::abs(fix.latitude_deg) <= 90.0, "a latitude beyond the pole");
    expect(std::abs(fix.longitude_deg) <= 180.0, "a longitude beyond 180 degrees");
    expect(fix.sigma_east_m >= 0.0 && fix.sigma_east_m < 1000.0, "a sigma out of range");
    expect(fix.sigma_north_m >= 0.0 && fix.sigma_north_m < 1000.0, "a sigma out of range");
    expect(!fix.course_deg || (*fix.course_deg >= 0.0 && *fix.course_deg < 360.0), "a course");
    expect(std::isfinite(fix.sigma_course_deg), "a sigma that is not finite");
    expect(fix.utc.count() >= 0, "a time before 1970");
  }
}

}  // namespace bevloc::fuzz
