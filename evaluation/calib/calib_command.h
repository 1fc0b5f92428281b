// `bevloc calib`: imports, checks and refines a calibration.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "command/command_list.h"
#include "common/result.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::evaluation {

class CalibCommand {
 public:
  void declare(CLI::App& app);
  /// Does what the parsed command line asks for. False if a check finds a camera that is not good.
  Result<command::Verdict> run() const;

 private:
  void declare_import(CLI::App& calib);
  void declare_check(CLI::App& calib);
  void declare_refine(CLI::App& calib);
  static void declare_inputs(CLI::App& command, CalibCommand& self);
  Status run_import() const;
  Result<bool> run_on_pictures() const;
  /// Writes the refined rig, if --out names a file.
  Status write_refined(const Rig& refined) const;

  bool import_ = false;
  bool check_ = false;
  bool refine_ = false;
  std::vector<std::string> files_;
  std::vector<std::string> camera_names_;
  std::string extrinsics_file_;
  std::string base_file_;
  std::string image_size_;
  std::vector<std::string> tokens_;
  std::string rig_file_;
  std::string map_file_;
  std::string folder_;
  double interval_s_ = 0.5;
  double reference_position_m_ = 0.03;
  double reference_yaw_deg_ = 0.1;
  std::vector<std::string> keep_;
  std::string picture_file_;
  std::string json_file_;
  std::string out_;
};

}  // namespace bevloc::evaluation
