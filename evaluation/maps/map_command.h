// `bevloc map`: imports, describes, checks, draws and compares maps.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::evaluation {

class MapCommand {
 public:
  void declare(CLI::App& app);
  /// Fails, before it reads anything, if an output file is also an input file.
  Status run() const;

 private:
  Status import() const;
  Status info() const;
  Status check() const;
  Status render() const;
  Status diff() const;
  Status check_picture() const;

  Status (MapCommand::*action_)() const = nullptr;
  std::string in_;
  std::string other_;
  std::string out_;
  std::string classes_;
  std::string origin_;
  std::string json_;
  std::string picture_;
  bool version_1_ = false;
  int size_px_ = 1200;
};

}  // namespace bevloc::evaluation
