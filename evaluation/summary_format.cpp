#include "evaluation/summary_format.h"

#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace bevloc::evaluation {
namespace {

constexpr std::array<std::pair<const char*, PerAxis Summary::*>, 8> kMeasures{{
    {"mae", &Summary::mae},
    {"rmse", &Summary::rmse},
    {"median", &Summary::median},
    {"p95", &Summary::p95},
    {"parabola_mae", &Summary::parabola_mae},
    {"nll", &Summary::nll},
    {"coverage_1s", &Summary::coverage_1s},
    {"coverage_3s", &Summary::coverage_3s},
}};

}  // namespace

std::string number_or_dash(double value, int digits) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits);
}

std::string three(const PerAxis& values, int digits) {
  return fmt::format("{} {} {}", number_or_dash(values[0], digits),
                     number_or_dash(values[1], digits), number_or_dash(values[2], digits));
}

std::string percent(const PerAxis& shares) {
  const auto text = [](double share) { return number_or_dash(100.0 * share, 0); };
  return fmt::format("{:>3} {:>3} {:>3}", text(shares[0]), text(shares[1]), text(shares[2]));
}

nlohmann::json json_of(const Summary& summary) {
  nlohmann::json json{{"scenes", summary.scenes}};
  for (const auto& [name, values] : kMeasures) json[name] = summary.*values;
  return json;
}

std::string csv_value(double value) {
  return std::isnan(value) ? "," : fmt::format(",{:.6g}", value);
}

std::string csv_columns() {
  std::string text;
  for (const auto& [name, values] : kMeasures) {
    for (const char* axis : {"x_m", "y_m", "yaw_deg"}) {
      fmt::format_to(std::back_inserter(text), ",{}_{}", name, axis);
    }
  }
  return text;
}

std::string csv_values(const Summary& summary) {
  std::string text;
  for (const auto& [name, values] : kMeasures) {
    for (const double value : summary.*values) text += csv_value(value);
  }
  return text;
}

}  // namespace bevloc::evaluation
