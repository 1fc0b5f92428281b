#include "evaluation/drive/progress_line.h"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace bevloc::evaluation {

void show_progress_line(const firmware::ApplianceView& appliance, const JudgeView& judge,
                        double time_s, double duration_s, bool last) {
  const bool is_terminal = isatty(STDERR_FILENO) == 1;
  if (!is_terminal && !last) return;
  std::string line = fmt::format("{:>5.1f}/{} s  {:<9}  cameras {}/{}  {:>4.1f} Hz",
                                 std::max(0.0, time_s), duration_s, to_string(appliance.state),
                                 appliance.cameras, kCameraCount, appliance.rate_hz);
  if (judge.latest) {
    const Se2 error = pose_error(judge.latest->truth, judge.latest->estimate);
    line += fmt::format("  error {:.2f} m long. {:.2f} m lat. {:.2f} deg", std::abs(error.x_m),
                        std::abs(error.y_m), std::abs(degrees(error.yaw_rad)));
  }
  // A line that cannot be written must not end the drive.
  std::fputs(fmt::format("{}{}{}", is_terminal ? "\r\033[K" : "", line, last ? "\n" : "").c_str(),
             stderr);
  std::fflush(stderr);
}

}  // namespace bevloc::evaluation
