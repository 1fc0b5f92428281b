// Reads YAML and JSON files of other programs: unknown keys are allowed, repeated ones and a second
// document are not, and every error has a line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <yaml-cpp/yaml.h>

#include "pipeline/calibration/camera_model.h"

namespace bevloc::calibration_import {

/// Only this folder throws it; import_rig() returns it as an error.
struct ImportError {
  std::string message;
};

/// Throws "place: found X, wanted Y".
[[noreturn]] void refuse(std::string_view place, std::string_view found, std::string_view wanted);

/// The number that the whole text spells. Throws unless it is a finite number.
double number_from(const std::string& text, std::string_view place);

/// One node of a document, with the keys that lead to it. All members throw ImportError.
class ForeignNode {
 public:
  /// `name` is the file in messages. A first line such as %YAML:1.0, which is not YAML, is skipped.
  static ForeignNode parse(const std::string& text, const std::string& name);

  bool is_map() const { return node_.IsMap(); }
  bool is_list() const { return node_.IsSequence(); }
  bool has(std::string_view key) const;
  ForeignNode at(std::string_view key) const;
  std::vector<ForeignNode> items() const;
  std::vector<std::pair<std::string, ForeignNode>> entries() const;

  double number() const;
  int whole_number(int least, int most) const;
  std::string text() const;
  /// A flat list of numbers. A `count` other than 0 is the required length.
  std::vector<double> numbers(size_t count = 0) const;

  /// The place of the node in messages: "file:line: key.of.maps".
  std::string place() const;
  [[noreturn]] void reject(std::string_view found, std::string_view wanted) const;

 private:
  ForeignNode(const YAML::Node& node, std::string name, std::string path);

  YAML::Node node_;
  std::string name_;
  std::string path_;
};

/// A rotation from a quaternion (w, x, y, z) whose norm is within 0.001 of 1.
Eigen::Matrix3d rotation_from_wxyz(const std::vector<double>& wxyz, std::string_view place);

/// A rigid transform from 16 numbers row by row. Throws unless the numbers form a rigid transform
/// to within 0.001.
Se3 rigid_from_rows(const std::vector<double>& rows, std::string_view place);

}  // namespace bevloc::calibration_import
