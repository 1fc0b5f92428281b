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

std::string three(const PerAxis& values, int digits) {
  const auto text = [digits](double value) {
    return std::isnan(value) ? std::string("-") : fmt::format("{:.{}f}", value, digits);
  };
  return fmt::format("{} {} {}", text(values[0]), text(values[1]), text(values[2]));
}

std::string percent(const PerAxis& shares) {
  const auto text = [](double share) {
    return std::isnan(share) ? std::string("-") : fmt::format("{:.0f}", 100.0 * share);
  };
  return fmt::format("{:>3} {:>3} {:>3}", text(shares[0]), text(shares[1]), text(shares[2]));
}

nlohmann::json json_of(const Summary& summary) {
  nlohmann::json json{{"scenes", summary.scenes}};
  for (const auto& [name, values] : kMeasures) json[name] = summary.*values;
  return json;
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
    for (double value : summary.*values) {
      text += std::isnan(value) ? "," : fmt::format(",{:.6g}", value);
    }
  }
  return text;
}

}  // namespace bevloc::evaluation
