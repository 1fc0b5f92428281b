#include "evaluation/recording/record_command.h"

#include "common/option_checks.h"
#include "common/replace_process.h"

namespace bevloc::evaluation {

void RecordCommand::declare(CLI::App& app) {
  auto* record = app.add_subcommand("record", "Run bevlocd and record what it sees and sends");
  record->add_option("--config", config_file_, "Configuration of bevlocd")
      ->required()
      ->check(is_name_of("a configuration"));
  record->add_option("--out", out_, "Folder of the recording")
      ->check(is_name_of("a folder"))
      ->capture_default_str();
  record->add_flag("--raw", raw_, "Record the images without loss");
  record->add_option("options", rest_, "Further options of bevlocd, after --, such as --fast");
  record->footer(
      "Examples:\n"
      "  bevloc record --config my_config.yaml --out recording\n"
      "  bevloc record --config config/demo.yaml --out recording --raw");
}

Status RecordCommand::run() const {
  std::vector<std::string> words{"--config", config_file_, "--record", out_};
  if (raw_) words.emplace_back("--record-raw");
  words.insert(words.end(), rest_.begin(), rest_.end());
  return replace_process(folder_of_this_program() / "bevlocd", std::move(words));
}

}  // namespace bevloc::evaluation
