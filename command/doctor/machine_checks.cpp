#include "command/doctor/machine_checks.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace bevloc::command {
namespace {

/// Returns the words of the first line that starts with "flags" (x86) or "Features" (Arm).
std::set<std::string> cpu_flags(const Machine& machine) {
  std::istringstream lines(machine.text_of("/proc/cpuinfo"));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("flags") && !line.starts_with("Features")) continue;
    std::istringstream words(line.substr(line.find(':') + 1));
    std::set<std::string> flags;
    for (std::string word; words >> word;) flags.insert(word);
    return flags;
  }
  return {};
}

Finding check_instructions(const std::set<std::string>& flags) {
  if (flags.contains("asimddp")) return ok("cpu", "dot product instructions (asimddp)");
  if (flags.contains("asimd")) {
    return {Level::kWarning, "cpu", "found no dot product instructions",
            "asimddp, without which the network is several times slower", "lscpu"};
  }
  std::vector<std::string> names;
  for (const auto& [flag, name] : std::map<std::string, std::string>{
           {"avx2", "AVX2"}, {"avx_vnni", "AVX-VNNI"}, {"avx512_vnni", "AVX512-VNNI"}}) {
    if (flags.contains(flag)) names.push_back(name);
  }
  const std::string found = fmt::format("{}", fmt::join(names, ", "));
  if (!flags.contains("avx2")) {
    return {Level::kProblem, "cpu", "found no AVX2",
            "AVX2, better AVX-VNNI or AVX512-VNNI; without AVX2 bevloc is too slow", "lscpu"};
  }
  if (names.size() > 1) return ok("cpu", found);
  return {Level::kWarning, "cpu", "found " + found + " without VNNI",
          "AVX-VNNI or AVX512-VNNI for the int8 network; measure with bevloc bench", "lscpu"};
}

/// Returns a value of /proc/meminfo, such as "Name: 123 kB", in bytes, or 0 if there is none.
int64_t memory_bytes(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(name + ":")) continue;
    std::istringstream number(line.substr(name.size() + 1));
    int64_t kib = 0;
    number >> kib;
    return kib * 1024;
  }
  return 0;
}

std::map<std::string, std::string> properties_of(const std::string& text) {
  std::map<std::string, std::string> properties;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const size_t equals = line.find('=');
    if (equals != std::string::npos) properties[line.substr(0, equals)] = line.substr(equals + 1);
  }
  return properties;
}

/// Whether a list of this kernel's modules, such as modules.builtin, has a module. The names of the
/// files have '-' in some places where the name of the module has '_'.
bool lists_module(const Machine& machine, const std::string& list, const std::string& module) {
  const std::string release = machine.line_of("/proc/sys/kernel/osrelease");
  std::string files = machine.text_of("/lib/modules/" + release + "/" + list);
  std::ranges::replace(files, '-', '_');
  return files.find("/" + module + ".ko") != std::string::npos;
}

/// The finding about a unit that systemd has not loaded.
Finding unloaded_unit(const std::string& load_state) {
  if (load_state == "not-found") {
    return {Level::kWarning, "unit", "found no bevlocd.service",
            "the unit, the user bevloc and /usr/bin/bevlocd",
            "sudo apt install ./bevloc_*.deb   # or the commands of docs/bring-up.md, step 2"};
  }
  if (load_state == "masked") {
    return {Level::kWarning, "unit", "found a masked unit, which nothing can start",
            "a unit without a mask", "sudo systemctl unmask bevlocd"};
  }
  return {Level::kProblem, "unit",
          fmt::format("found a unit that systemd refuses ({})", load_state),
          "a unit that systemd loads", "systemd-analyze verify bevlocd.service"};
}

std::string mib(int64_t bytes) {
  return fmt::format("{} MiB", bytes / (int64_t{1} << 20));
}

}  // namespace

Findings check_cpu(const Machine& machine) {
  Findings findings{check_instructions(cpu_flags(machine))};
  std::set<std::string> governors;
  for (const std::string& cpu : machine.names_in("/sys/devices/system/cpu")) {
    const std::string governor =
        machine.line_of("/sys/devices/system/cpu/" + cpu + "/cpufreq/scaling_governor");
    if (!governor.empty()) governors.insert(governor);
  }
  if (governors.empty()) {
    findings.push_back(ok("governor", "none: the kernel does not change the frequency"));
  } else if (governors == std::set<std::string>{"performance"}) {
    findings.push_back(ok("governor", "performance"));
  } else {
    findings.push_back({Level::kWarning, "governor",
                        fmt::format("found {}", fmt::join(governors, ", ")),
                        "performance: the network's time then varies less",
                        "echo performance | sudo tee "
                        "/sys/devices/system/cpu/cpu*/cpufreq/scaling_governor"});
  }
  return findings;
}

Findings check_room(const Machine& machine) {
  // bevlocd needs up to 76 MiB, and 73 MiB for each 1,000 km of road in the map.
  constexpr int64_t kMemory = int64_t{256} << 20;
  constexpr int64_t kDisk = int64_t{1} << 30;
  Findings findings;
  const int64_t memory = memory_bytes(machine.text_of("/proc/meminfo"), "MemAvailable");
  findings.push_back(memory >= kMemory
                         ? ok("memory", mib(memory) + " available")
                         : Finding{Level::kProblem, "memory", "found " + mib(memory) + " available",
                                   mib(kMemory), "ps aux --sort=-rss | head"});
  const char* const folder = machine.exists("/var/lib") ? "/var/lib" : "/";
  const Result<int64_t> disk = machine.free_bytes(folder);
  if (!disk) {
    findings.push_back({Level::kProblem, "disk", disk.error().message, "a file system", "df -h"});
  } else if (*disk < kDisk) {
    findings.push_back(
        {Level::kWarning, "disk", fmt::format("found {} free in {}", mib(*disk), folder),
         mib(kDisk) + " for recordings and logs", "sudo journalctl --vacuum-size=200M"});
  } else {
    findings.push_back(ok("disk", fmt::format("{} free in {}", mib(*disk), folder)));
  }
  return findings;
}

Findings check_clock(const Machine& machine) {
  if (machine.clock_is_synchronous()) return {ok("clock", "synchronous")};
  return {
      {Level::kWarning, "clock", "found a clock that no time service keeps synchronous",
       "NTP, PTP or GNSS time, so that the times in logs and recordings of several machines agree",
       "sudo timedatectl set-ntp true"}};
}

Findings check_unit(const Machine& machine) {
  const auto text =
      machine.run({"systemctl", "show", "bevlocd.service",
                   "--property=LoadState,ActiveState,SubState,UnitFileState,NRestarts"});
  if (!text) {
    return {{Level::kWarning, "unit", "found no systemd that answers",
             "systemd, which starts bevlocd again after a failure", "systemctl status"}};
  }
  auto state = properties_of(*text);
  if (state["LoadState"] != "loaded") return {unloaded_unit(state["LoadState"])};
  const std::string now = fmt::format("{} ({}), {} restarts", state["ActiveState"],
                                      state["SubState"], state["NRestarts"]);
  Findings findings;
  if (state["ActiveState"] == "active") {
    findings.push_back(ok("unit", now));
  } else if (state["ActiveState"] == "failed" || state["SubState"] == "auto-restart") {
    findings.push_back({Level::kProblem, "unit", "found " + now, "active",
                        "journalctl -u bevlocd -n 50 --no-pager"});
  } else {
    findings.push_back(
        {Level::kWarning, "unit", "found " + now, "active", "sudo systemctl start bevlocd"});
  }
  if (state["UnitFileState"] == "disabled") {
    findings.push_back({Level::kWarning, "unit", "found a unit that does not start with the system",
                        "an enabled unit", "sudo systemctl enable bevlocd"});
  }
  return findings;
}

Finding check_module(const Machine& machine, const std::string& module, Level if_missing) {
  const std::string part = "module " + module;
  if (machine.exists("/sys/module/" + module)) return ok(part, "loaded");
  if (lists_module(machine, "modules.builtin", module)) return ok(part, "built in");
  return {if_missing, part, "found a module that is not loaded", "a loaded module",
          "sudo modprobe " + module};
}

Finding check_module_on_demand(const Machine& machine, const std::string& module) {
  Finding finding = check_module(machine, module, Level::kProblem);
  if (finding.level == Level::kOk || !lists_module(machine, "modules.dep", module)) return finding;
  return ok(finding.part, "not loaded; the kernel loads it when it is used first");
}

}  // namespace bevloc::command
