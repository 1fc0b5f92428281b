#include "command/init/init_command.h"

#include <algorithm>
#include <iostream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "command/shell_word.h"
#include "common/option_checks.h"
#include "common/replace_file.h"
#include "common/shipped_file.h"
#include "firmware/devices/config_check.h"

namespace bevloc::command {
namespace {

Status wanted_file(const std::string& place, const std::string& file) {
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error)) return {};
  return fail("{}: found no file \"{}\", wanted one that exists", place, file);
}

std::string shipped_or_empty(const std::string& name) {
  const auto file = shipped_file(name);
  return file ? file->string() : "";
}

/// Asks for a file unless the command line gave it.
Result<std::string> file_of(Dialog& dialog, const std::string& given, const std::string& question,
                            const std::string& option, const std::string& proposal,
                            bool may_be_empty) {
  const auto check = [&](const std::string& file) {
    return may_be_empty && file.empty() ? Status() : wanted_file(option, file);
  };
  if (given.empty()) return dialog.ask(question, proposal, check);
  if (const Status good = check(given); !good) return tl::unexpected(good.error());
  return given;
}

/// Returns a numbered list of a driver's cameras.
std::string list_of_cameras(const std::string& driver, const std::vector<OfferedCamera>& cameras) {
  std::string text = driver + " cameras:";
  if (cameras.empty()) return text + " none";
  for (size_t i = 0; i < cameras.size(); ++i) {
    text += fmt::format("\n  {}: {} ({})", i + 1, cameras[i].id, cameras[i].name);
  }
  return text;
}

/// Returns the id of a camera that was named by its number in the list or by its id.
std::string id_from(const std::vector<OfferedCamera>& cameras, const std::string& answer) {
  const bool is_number =
      !answer.empty() && answer.size() < 3 && std::ranges::all_of(answer, isdigit);
  const size_t number = is_number ? std::stoul(answer) : 0;
  return number >= 1 && number <= cameras.size() ? cameras[number - 1].id : answer;
}

/// Writes the configuration. The daemon runs as another user, so all users may read a new file,
/// whatever the umask is.
Status write_configuration(const std::filesystem::path& file, std::string_view text) {
  using std::filesystem::perms;
  std::error_code error;
  const bool is_new = !std::filesystem::exists(file, error);
  if (Status written = replace_file_with_backup(file, text); !written || !is_new) return written;
  std::filesystem::permissions(file, perms::group_read | perms::others_read,
                               std::filesystem::perm_options::add, error);
  if (!error) return {};
  return fail("{}: found no way to let all users read this file ({}), wanted one; use chmod a+r",
              file.string(), error.message());
}

}  // namespace

void InitCommand::declare(CLI::App& app) {
  auto* init = app.add_subcommand(
      "init", "Write a configuration for this machine, and check it; asks for what is not given");
  init->add_option("--out", out_, "The configuration to write")
      ->check(replaced_file())
      ->capture_default_str();
  init->add_flag("--force", force_, "Replace a file that exists; the one before is kept as .bak");
  init->add_flag("--yes", yes_, "Ask nothing: take what is proposed");
  std::vector<std::string> drivers{kV4l2Cameras, kLibcameraCameras};
  if (simulation_ != nullptr) drivers.insert(drivers.begin(), kMockCameras);
  init->add_option("--cameras", driver_, "Driver of the cameras")->check(CLI::IsMember(drivers));
  init->add_option(
          "--id", ids_,
          "Ids of the six cameras, in the order front_left, front, front_right, back_left, "
          "back, back_right")
      ->expected(kCameraCount);
  init->add_option("--rig", rig_, "Rig file")->check(CLI::ExistingFile);
  init->add_option("--map", map_, "HD map")->check(CLI::ExistingFile);
  init->add_option("--model", model_, "Network")->check(CLI::ExistingFile);
  init->add_option("--can", can_,
                   simulation_ != nullptr ? "CAN interface, or mock" : "CAN interface");
  init->footer(fmt::format(
      "Exit code: 0 written and good, 1 written but the check found a mistake, 2 not written.\n"
      "Examples:\n"
      "  bevloc init\n"
      "{}"
      "  bevloc init --cameras v4l2 --rig rig.yaml --map town.osm --can can0",
      simulation_ != nullptr ? "  bevloc init --yes --out my_config.yaml\n" : ""));
}

Result<std::string> InitCommand::driver(const Offers& offers, Dialog& dialog) const {
  if (!driver_.empty()) return driver_;
  dialog.say(list_of_cameras(kV4l2Cameras, offers.v4l2));
  dialog.say(list_of_cameras(kLibcameraCameras, offers.libcamera));
  std::vector<std::string> known{kV4l2Cameras, kLibcameraCameras};
  if (simulation_ != nullptr) known.emplace_back(kMockCameras);
  std::string proposal = simulation_ != nullptr ? kMockCameras : kV4l2Cameras;
  if (offers.libcamera.size() >= kCameraCount) proposal = kLibcameraCameras;
  if (offers.v4l2.size() >= kCameraCount) proposal = kV4l2Cameras;
  return dialog.ask(fmt::format("Driver of the cameras ({})", fmt::join(known, ", ")), proposal,
                    [&known](const std::string& answer) -> Status {
                      if (std::ranges::find(known, answer) != known.end()) return {};
                      return fail("--cameras: found \"{}\", wanted one of {}", answer,
                                  fmt::join(known, ", "));
                    });
}

Status InitCommand::cameras(const std::vector<OfferedCamera>& offered, Dialog& dialog,
                            Answers& answers) const {
  // driver() has shown the lists, unless the command line gave the driver.
  if (ids_.empty() && !driver_.empty()) dialog.say(list_of_cameras(driver_, offered));
  for (size_t camera = 0; camera < kCameraCount; ++camera) {
    if (!ids_.empty()) {
      answers.ids[camera] = ids_[camera];
      continue;
    }
    const auto is_new = [&](const std::string& answer) -> Status {
      const std::string id = id_from(offered, answer);
      if (id.empty()) {
        return fail("--id: found {} cameras, wanted six: connect them, or give their ids",
                    offered.size());
      }
      const auto before = answers.ids.begin() + static_cast<std::ptrdiff_t>(camera);
      if (std::find(answers.ids.begin(), before, id) == before) return {};
      return fail("--id: found \"{}\" a second time, wanted a different one for each camera", id);
    };
    const std::string proposal = camera < offered.size() ? offered[camera].id : "";
    const auto answer =
        dialog.ask(fmt::format("Camera {} (number or id)", kCameraNames[camera]), proposal, is_new);
    if (!answer) return tl::unexpected(answer.error());
    answers.ids[camera] = id_from(offered, *answer);
  }
  return {};
}

Result<std::string> InitCommand::can(const Offers& offers, Dialog& dialog,
                                     const std::string& driver) const {
  const bool mock = driver == kMockCameras;
  const auto check = [mock](const std::string& answer) -> Status {
    if (answer == kMockCameras && !mock) {
      return fail("--can: found mock beside real cameras, wanted an interface such as can0");
    }
    if (answer.empty() || answer.size() > 15) {
      return fail("--can: found no name of an interface, wanted one such as can0");
    }
    return {};
  };
  if (!can_.empty()) {
    if (const Status good = check(can_); !good) return tl::unexpected(good.error());
    return can_;
  }
  const std::vector<std::string>& found = offers.can_interfaces;
  dialog.say(fmt::format("CAN interfaces: {}",
                         found.empty() ? "none" : fmt::format("{}", fmt::join(found, ", "))));
  const std::string proposal = mock ? kMockCameras : found.empty() ? "" : found.front();
  return dialog.ask(mock ? "CAN interface, or mock" : "CAN interface", proposal, check);
}

Result<Answers> InitCommand::answers(const Offers& offers, Dialog& dialog) const {
  Answers answers;
  const auto chosen = driver(offers, dialog);
  if (!chosen) return tl::unexpected(chosen.error());
  answers.driver = *chosen;
  const bool mock = answers.driver == kMockCameras;
  if (mock && !ids_.empty()) {
    return fail(
        "--id: found ids beside mock cameras, which have none; leave out --id, or choose "
        "--cameras {}",
        kV4l2Cameras);
  }
  if (!mock) {
    const auto& offered = answers.driver == kLibcameraCameras ? offers.libcamera : offers.v4l2;
    if (Status status = cameras(offered, dialog, answers); !status) {
      return tl::unexpected(status.error());
    }
  }
  const auto rig = file_of(dialog, rig_, "Rig file (calibration of the cameras)", "--rig",
                           mock ? shipped_or_empty("config/rig_demo.yaml") : "", false);
  if (!rig) return tl::unexpected(rig.error());
  const auto map = file_of(dialog, map_, mock ? "HD map (empty: a simulated town)" : "HD map",
                           "--map", "", mock);
  if (!map) return tl::unexpected(map.error());
  const auto model =
      file_of(dialog, model_, "Network", "--model", shipped_or_empty("models/nano.onnx"), false);
  if (!model) return tl::unexpected(model.error());
  const auto bus = can(offers, dialog, answers.driver);
  if (!bus) return tl::unexpected(bus.error());
  answers.rig = *rig;
  answers.map = *map;
  answers.model = *model;
  answers.can = *bus;
  return answers;
}

Result<Verdict> InitCommand::run() const {
  const LinuxMachine machine;
  Dialog dialog(std::cin, std::cout, !yes_ && isatty(STDIN_FILENO) != 0);
  return run(offers_of(machine, libcamera_ids_of_this_machine()), dialog);
}

Result<Verdict> InitCommand::run(const Offers& offers, Dialog& dialog) const {
  std::error_code error;
  if (!force_ && std::filesystem::exists(out_, error)) {
    return fail("{}: found a file, wanted none; --force replaces it, --out takes another name",
                out_);
  }
  const auto known = answers(offers, dialog);
  if (!known) return tl::unexpected(known.error());
  const std::filesystem::path folder = std::filesystem::absolute(out_).parent_path();
  const std::string text = configuration_text(*known, folder);
  if (Status written = write_configuration(out_, text); !written) {
    return tl::unexpected(written.error());
  }
  const auto config = firmware::load_config(out_, simulation_);
  const Status checked = config ? check_config(*config) : Status(tl::unexpected(config.error()));
  if (checked) {
    fmt::print("{}: written, good. Next: bevlocd --config {}\n", out_, shell_word(out_));
    return Verdict::kGood;
  }
  fmt::print("{}: written, but the check found a mistake:\n  {}\n", out_, checked.error().message);
  fmt::print("Mend it, then: bevlocd --config {} --check-config\n", shell_word(out_));
  return Verdict::kBad;
}

}  // namespace bevloc::command
