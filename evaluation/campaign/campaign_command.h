// `bevloc campaign`: runs failure modes and says how the appliance reacts.
//
// evaluation/campaign, from the command down:
//   campaign_command  options of `bevloc campaign`; script/campaign runs it in parallel
//   campaign_inputs   what it shares with `bevloc eval integrity`
//   campaign          modes x seeds
//   modes             the failure modes, in lists by the input that fails
//   stage_run         one run of the estimation stage with the modelled matcher (--level stage)
//   modelled_vision   in place of cameras and network; modes/match_fault.h: its faults
//   match_model       replays measured matches; match_table, match_recorder: how they are measured
//   cycle_reader      reads every pose from the bus and compares it with the truth
//   run_outcome       what a run shows; protection_counts: how it keeps the protection levels
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "evaluation/campaign/campaign_inputs.h"

namespace bevloc::evaluation {

class CampaignCommand {
 public:
  void declare(CLI::App& app);

  /// Does what the parsed command line asks for.
  Status run() const;

  /// Whether the parsed command line names this command.

 private:
  Status list() const;

  bool list_ = false;
  bool timeline_ = false;
  CampaignInputs inputs_;
  std::string json_file_;
};

}  // namespace bevloc::evaluation
