#include "evaluation/campaign/integrity_command.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/option_checks.h"
#include "evaluation/campaign/stanford_diagram.h"
#include "evaluation/choice_option.h"
#include "evaluation/command_output.h"
#include "evaluation/town_seeds.h"

namespace bevloc::evaluation {
namespace {

constexpr std::string_view kFaultFree = "none";

}  // namespace

void IntegrityCommand::declare(CLI::App& eval) {
  auto* integrity = eval.add_subcommand(
      "integrity", "Compare errors with protection levels over drives and failure modes");
  add_choice(*integrity, "--level", options_.level,
             {{"stage", Level::kStage}, {"pictures", Level::kPictures}},
             "stage: the estimation stage with a matcher whose errors were measured; pictures: the "
             "whole appliance");
  integrity->add_option("--drives", options_.seeds, "Number of seeds; each drives every mode")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  integrity->add_option("--first-seed", options_.first_seed, "The first seed")
      ->check(whole_number())
      ->capture_default_str();
  integrity->add_option("--duration", options_.duration_s, "Length of each drive, seconds")
      ->check(number_between(5.0, 1e6))
      ->capture_default_str();
  integrity->add_option("--modes", modes_, "Modes (`bevloc campaign --list`); without: all");
  integrity->add_option("--map", maps_, "Every second seed drives through one of these, in turn")
      ->check(name_of("a map"));
  integrity->add_option("--config", config_, "Configuration with mock cameras")
      ->capture_default_str();
  integrity->add_option("--matches", table_, "Measured matches for --level stage")
      ->capture_default_str();
  integrity->add_option("--json", json_file_, "Write the diagrams as JSON to this file")
      ->check(output_file());
  integrity->footer(
      "Examples:\n"
      "  bevloc eval integrity --modes none --drives 200\n"
      "  bevloc eval integrity --drives 20 --json integrity.json");
  integrity->callback([this] { chosen_ = true; });
}

Status IntegrityCommand::run() const {
  if (Status towns = check_town_seeds("--first-seed", options_.first_seed, options_.seeds);
      !towns) {
    return towns;
  }
  spdlog::set_level(spdlog::level::err);
  const auto modes = modes_named(modes_, options_.level);
  if (!modes) return tl::unexpected(modes.error());
  const auto campaign = Campaign::create(config_, table_, options_);
  if (!campaign) return tl::unexpected(campaign.error());
  std::vector<NamedDiagram> diagrams{{"no fault", {}}, {"with faults", {}}};
  const int runs = options_.seeds * static_cast<int>(modes->size());
  int done = 0;
  for (int k = 0; k < options_.seeds; ++k) {
    const auto number = static_cast<size_t>(k);
    const bool on_map = !maps_.empty() && k % 2 == 1;
    const std::string map = on_map ? maps_[number / 2 % maps_.size()] : std::string();
    for (const Mode* mode : *modes) {
      StanfordDiagram& diagram = diagrams[mode->name == kFaultFree ? 0 : 1].diagram;
      bool has_fix = false;
      const Status status =
          campaign->drive(*mode, options_.first_seed + number, map, [&](const JudgedCycle& cycle) {
            has_fix = has_fix || cycle.pose.has_value();
            if (has_fix) diagram.add(cycle);
          });
      if (!status) return status;
      show_progress(++done, runs, "drives");
    }
  }
  fmt::print("{}", to_table(diagrams));
  return write_file(to_json(diagrams), json_file_);
}

}  // namespace bevloc::evaluation
