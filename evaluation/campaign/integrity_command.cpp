#include "evaluation/campaign/integrity_command.h"

#include <fmt/format.h>

#include "common/option_checks.h"
#include "common/output_file.h"
#include "evaluation/campaign/stanford_diagram.h"
#include "evaluation/map_turns.h"
#include "evaluation/progress_bar.h"

namespace bevloc::evaluation {

void IntegrityCommand::declare(CLI::App& eval) {
  auto* integrity = eval.add_subcommand(
      "integrity", "Compare errors with protection levels over drives and failure modes");
  integrity->add_option("--modes", inputs_.modes,
                        "Names of modes (`bevloc campaign --list`); default: all");
  integrity
      ->add_option("--drives", inputs_.options.seeds, "Number of seeds; each drives every mode")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  inputs_.declare(*integrity);
  integrity->add_option("--map", maps_, "Every second seed drives through one of these, in turn")
      ->check(is_name_of("a map"));
  integrity->add_option("--json", json_file_, "Write the diagrams as JSON to this file")
      ->check(output_file());
  integrity->footer(
      "Examples:\n"
      "  bevloc eval integrity --modes none --drives 200\n"
      "  bevloc eval integrity --drives 20 --json integrity.json");
}

Status IntegrityCommand::run() const {
  const CampaignOptions& options = inputs_.options;
  if (Status driven = check_map_turns(maps_, "--drives", options.seeds); !driven) return driven;
  const auto loaded = inputs_.load(maps_, json_file_);
  if (!loaded) return tl::unexpected(loaded.error());
  std::vector<NamedDiagram> diagrams{{"no fault", {}}, {"with faults", {}}};
  const int runs = options.seeds * static_cast<int>(loaded->modes.size());
  int done = 0;
  for (int k = 0; k < options.seeds; ++k) {
    const uint64_t seed = options.first_seed + static_cast<uint64_t>(k);
    const std::string map = map_of_drive(maps_, k);
    for (const Mode* mode : loaded->modes) {
      StanfordDiagram& diagram = diagrams[mode->fails() ? 1 : 0].diagram;
      diagram.begin_drive();
      const Status status = loaded->campaign.drive(
          *mode, seed, map, [&diagram](const JudgedCycle& cycle) { diagram.add(cycle); });
      if (!status) return status;
      show_progress(++done, runs, "drives");
    }
  }
  fmt::print("{}", to_table(diagrams));
  return write_option_file(json_file_, to_json(diagrams));
}

}  // namespace bevloc::evaluation
