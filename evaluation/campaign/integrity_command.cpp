#include "evaluation/campaign/integrity_command.h"

#include <fmt/format.h>

#include "common/option_checks.h"
#include "evaluation/campaign/stanford_diagram.h"
#include "evaluation/command_output.h"

namespace bevloc::evaluation {
namespace {

constexpr std::string_view kFaultFree = "none";

}  // namespace

void IntegrityCommand::declare(CLI::App& eval) {
  auto* integrity = eval.add_subcommand(
      "integrity", "Compare errors with protection levels over drives and failure modes");
  integrity->add_option("--modes", inputs_.modes, "Modes (`bevloc campaign --list`); without: all");
  integrity
      ->add_option("--drives", inputs_.options.seeds, "Number of seeds; each drives every mode")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  inputs_.declare(*integrity);
  integrity->add_option("--map", maps_, "Every second seed drives through one of these, in turn")
      ->check(name_of("a map"));
  integrity->add_option("--json", json_file_, "Write the diagrams as JSON to this file")
      ->check(output_file());
  integrity->footer(
      "Examples:\n"
      "  bevloc eval integrity --modes none --drives 200\n"
      "  bevloc eval integrity --drives 20 --json integrity.json");
  integrity->callback([this] { chosen_ = true; });
}

Status IntegrityCommand::run() const {
  const auto loaded = inputs_.load();
  if (!loaded) return tl::unexpected(loaded.error());
  const CampaignOptions& options = inputs_.options;
  std::vector<NamedDiagram> diagrams{{"no fault", {}}, {"with faults", {}}};
  const int runs = options.seeds * static_cast<int>(loaded->modes.size());
  int done = 0;
  for (int k = 0; k < options.seeds; ++k) {
    const auto number = static_cast<size_t>(k);
    const bool on_map = !maps_.empty() && k % 2 == 1;
    const std::string map = on_map ? maps_[number / 2 % maps_.size()] : std::string();
    for (const Mode* mode : loaded->modes) {
      StanfordDiagram& diagram = diagrams[mode->name == kFaultFree ? 0 : 1].diagram;
      bool has_fix = false;
      const Status status = loaded->campaign.drive(*mode, options.first_seed + number, map,
                                                   [&](const JudgedCycle& cycle) {
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
