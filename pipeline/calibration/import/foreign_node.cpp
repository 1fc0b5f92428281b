#include "pipeline/calibration/import/foreign_node.h"

#include <cmath>
#include <set>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include "common/number_text.h"
#include "common/yaml_text.h"
#include "pipeline/calibration/unit_quaternion.h"

namespace bevloc::calibration_import {
namespace {

std::string described(const YAML::Node& node) {
  if (node.IsScalar()) return fmt::format("\"{}\"", node.Scalar().substr(0, 60));
  if (node.IsSequence()) return fmt::format("a list of {}", node.size());
  return node.IsMap() ? "a mapping" : "nothing";
}

}  // namespace

void refuse(std::string_view place, std::string_view found, std::string_view wanted) {
  throw ImportError{fmt::format("{}: found {}, wanted {}", place, found, wanted)};
}

double number_from(const std::string& text, std::string_view place) {
  const auto value =
      parse_number<double>(std::string_view(text).substr(text.starts_with('+') ? 1 : 0));
  if (!value || !std::isfinite(*value)) {
    refuse(place, fmt::format("\"{}\"", text.substr(0, 60)), "a number");
  }
  return *value;
}

ForeignNode ForeignNode::parse(const std::string& text, const std::string& name) {
  std::string yaml = text;
  // OpenCV's header lacks the space that YAML demands. The line stays as a comment, so that line
  // numbers are right.
  if (yaml.starts_with("%YAML:")) yaml[0] = '#';
  Result<YAML::Node> node = parse_document(yaml, name);
  if (!node) throw ImportError{std::move(node.error().message)};
  return {*node, name, ""};
}

ForeignNode::ForeignNode(const YAML::Node& node, std::string name, std::string path)
    : node_(node), name_(std::move(name)), path_(std::move(path)) {
  if (!is_map()) return;
  std::set<std::string> keys;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar() || keys.insert(entry.first.Scalar()).second) continue;
    refuse(ForeignNode(entry.first, name_, path_).place(),
           fmt::format("{} again", entry.first.Scalar()), "each key once");
  }
}

bool ForeignNode::has(std::string_view key) const {
  return is_map() && node_[std::string(key)].IsDefined();
}

ForeignNode ForeignNode::at(std::string_view key) const {
  if (!is_map()) reject(described(node_), fmt::format("a mapping with {}", key));
  const YAML::Node found = node_[std::string(key)];
  if (!found.IsDefined()) reject(fmt::format("no {}", key), "one");
  return {found, name_, path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key)};
}

std::vector<ForeignNode> ForeignNode::items() const {
  if (!is_list()) reject(described(node_), "a list");
  std::vector<ForeignNode> result;
  for (const YAML::Node& item : node_) {
    result.push_back(ForeignNode(item, name_, fmt::format("{}[{}]", path_, result.size())));
  }
  return result;
}

std::vector<std::pair<std::string, ForeignNode>> ForeignNode::entries() const {
  std::vector<std::pair<std::string, ForeignNode>> result;
  if (!is_map()) reject(described(node_), "a mapping");
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) reject("a key that is not a word", "words as keys");
    const std::string& key = entry.first.Scalar();
    result.emplace_back(key,
                        ForeignNode(entry.second, name_, path_.empty() ? key : path_ + "." + key));
  }
  return result;
}

double ForeignNode::number() const {
  if (!node_.IsScalar()) reject(described(node_), "a number");
  return number_from(node_.Scalar(), place());
}

int ForeignNode::whole_number(int least, int most) const {
  const double value = number();
  if (!(value >= least && value <= most) || value != std::floor(value)) {
    reject(described(node_), fmt::format("a whole number from {} to {}", least, most));
  }
  return static_cast<int>(value);
}

std::string ForeignNode::text() const {
  if (!node_.IsScalar()) reject(described(node_), "a text");
  return node_.Scalar();
}

std::vector<double> ForeignNode::numbers(size_t count) const {
  if (!is_list()) reject(described(node_), "a list of numbers");
  std::vector<double> result;
  for (const ForeignNode& item : items()) result.push_back(item.number());
  if (count != 0 && result.size() != count) {
    reject(fmt::format("{} numbers", result.size()), fmt::format("{} numbers", count));
  }
  return result;
}

std::string ForeignNode::place() const {
  const std::string line = fmt::format("{}:{}", name_, node_.Mark().line + 1);
  return path_.empty() ? line : line + ": " + path_;
}

void ForeignNode::reject(std::string_view found, std::string_view wanted) const {
  refuse(place(), found, wanted);
}

Eigen::Matrix3d rotation_from_wxyz(const std::vector<double>& wxyz, std::string_view place) {
  const auto rotation = rotation_from_quaternion(wxyz);
  if (!rotation) refuse(place, rotation.error().message, "a unit quaternion w, x, y, z");
  return *rotation;
}

Se3 rigid_from_rows(const std::vector<double>& rows, std::string_view place) {
  constexpr double kTolerance = 1e-3;
  using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Matrix4 matrix = Eigen::Map<const Matrix4>(rows.data());
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const double skew = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm();
  const bool last_row = (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < kTolerance;
  if (!(skew <= kTolerance) || !(rotation.determinant() > 0.0) || !last_row) {
    refuse(place, "a matrix that is no rotation with a translation",
           "a rigid transform of 4 x 4 numbers");
  }
  return {Eigen::Quaterniond(rotation).normalized().toRotationMatrix(),
          matrix.topRightCorner<3, 1>()};
}

}  // namespace bevloc::calibration_import
