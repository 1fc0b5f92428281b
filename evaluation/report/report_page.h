// The report as one HTML page without outside addresses.
#pragma once

#include <string>
#include <vector>

#include "evaluation/report/report_data.h"

namespace bevloc::evaluation {

/// A moment whose pictures the report shows.
struct ShownFrame {
  double time_s = 0.0;
  std::string why;                                 ///< why it is shown
  std::array<std::string, kCameraCount> pictures;  ///< JPEG files; empty without a picture
  std::array<bool, kCameraCount> unreadable{};     ///< whether a picture cannot be read
};

/// The moments with the largest errors; without truth those with the worst matches. At most three,
/// at least two seconds apart.
std::vector<ShownFrame> choose_frames(const ReportData& data);

/// A question about a moment, and the answer of explain().
struct Answer {
  std::string question;
  std::vector<std::string> sentences;
};

/// `names`: the names of the files. `facts`: more lines for the head of the page, name and text.
std::string report_page(const ReportData& data, const std::vector<std::string>& names,
                        const std::vector<std::pair<std::string, std::string>>& facts,
                        const std::vector<ShownFrame>& frames, const std::vector<Answer>& answers);

/// Means and 95 % quantiles of the errors, or of the corrections when there is no truth, and of the
/// latency: name and text.
std::vector<std::pair<std::string, std::string>> key_figures(const ReportData& data);

}  // namespace bevloc::evaluation
