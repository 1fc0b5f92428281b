// Tests the doctor on machines that are folders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command/doctor/config_checks.h"
#include "command/doctor/doctor_command.h"
#include "command/doctor/machine_checks.h"
#include "pipeline/calibration/rig_yaml.h"
#include "tests/command/fake_machine.h"
#include "tests/support/demo_rig.h"
#include "tests/support/turned_rig.h"

namespace bevloc::command {
namespace {

using test::FakeMachine;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

firmware::Config socketcan_config(const std::string& interface) {
  firmware::Config config;
  config.can.driver = firmware::CanDriver::kSocketCan;
  config.can.interface = interface;
  return config;
}

/// What `ip -details -json link show can0` of iproute2 6.1 prints, shortened.
std::string ip_answer(const std::string& state, int tx_errors, int restart_ms) {
  return R"([{"ifname":"can0","flags":["NOARP","UP"],"linkinfo":{"info_kind":"can","info_data":{)"
         R"("state":")" +
         state + R"(","berr_counter":{"tx":)" + std::to_string(tx_errors) +
         R"(,"rx":0},"restart_ms":)" + std::to_string(restart_ms) +
         R"(,"bittiming":{"bitrate":500000}}}}])";
}

class DoctorTest : public testing::Test {
 protected:
  DoctorTest() {
    machine_.put("/sys/module/can/refcnt", "1");
    machine_.put("/sys/module/can_raw/refcnt", "1");
    machine_.put("/sys/class/net/can0/type", "280\n");
  }
  /// The finding about the interface can0.
  Finding can0() {
    for (const Finding& finding : check_can_interface(machine_, socketcan_config("can0"))) {
      if (finding.part == "can0") return finding;
    }
    ADD_FAILURE() << "nothing about can0";
    return {};
  }

  FakeMachine machine_;
};

TEST_F(DoctorTest, JudgesTheInstructionsOfTheCpu) {
  const auto level = [this](const std::string& flags) {
    machine_.put("/proc/cpuinfo", "processor : 0\nflags\t\t: fpu " + flags + "\n");
    return check_cpu(machine_).front().level;
  };
  EXPECT_EQ(level("avx2 avx512_vnni"), Level::kOk);
  EXPECT_EQ(level("avx2 avx_vnni"), Level::kOk);
  EXPECT_EQ(level("avx2"), Level::kWarning);
  EXPECT_EQ(level("sse4_2"), Level::kProblem);
  machine_.put("/proc/cpuinfo", "processor : 0\nFeatures : fp asimd asimddp\n");
  EXPECT_EQ(check_cpu(machine_).front().level, Level::kOk);
}

TEST_F(DoctorTest, NamesAGovernorThatSavesPower) {
  machine_.put("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance\n");
  EXPECT_EQ(check_cpu(machine_).back().level, Level::kOk);
  machine_.put("/sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave\n");
  EXPECT_EQ(check_cpu(machine_).back().level, Level::kWarning);
  EXPECT_THAT(check_cpu(machine_).back().found, HasSubstr("powersave"));
}

TEST_F(DoctorTest, FindsModulesThatAreLoadedBuiltInOrMissing) {
  EXPECT_EQ(check_module(machine_, "can", Level::kProblem).found, "loaded");
  machine_.put("/proc/sys/kernel/osrelease", "6.1.0\n");
  machine_.put("/lib/modules/6.1.0/modules.builtin", "kernel/drivers/net/can/vcan.ko\n");
  EXPECT_EQ(check_module(machine_, "vcan", Level::kProblem).found, "built in");
  const Finding missing = check_module(machine_, "uvcvideo", Level::kWarning);
  EXPECT_EQ(missing.level, Level::kWarning);
  EXPECT_EQ(missing.fix, "sudo modprobe uvcvideo");
}

/// modules.builtin has the names of the files, with '-' where the kernel's names have '_'.
TEST_F(DoctorTest, ReadsMinusAndUnderscoreInNamesOfModulesAsEqual) {
  machine_.put("/proc/sys/kernel/osrelease", "6.1.0\n");
  machine_.put("/lib/modules/6.1.0/modules.builtin", "kernel/net/can/can-gw.ko\n");
  EXPECT_EQ(check_module(machine_, "can_gw", Level::kProblem).found, "built in");
  EXPECT_EQ(check_module(machine_, "can_isotp", Level::kProblem).level, Level::kProblem);
}

TEST(DoctorOfCanModules, AcceptsThoseThatTheKernelLoadsByItself) {
  FakeMachine machine;
  const auto levels = [&machine] {
    const Findings findings = check_can_interface(machine, socketcan_config("can0"));
    return std::vector{findings[0].level, findings[1].level};
  };
  machine.put("/proc/sys/kernel/osrelease", "6.1.0\n");
  EXPECT_EQ(levels(), (std::vector{Level::kProblem, Level::kProblem}));
  machine.put("/lib/modules/6.1.0/modules.dep",
              "kernel/net/can/can.ko.xz:\n"
              "kernel/net/can/can-raw.ko.xz: kernel/net/can/can.ko.xz\n");
  EXPECT_EQ(levels(), (std::vector{Level::kOk, Level::kOk}));
}

TEST_F(DoctorTest, JudgesTheCanController) {
  machine_.programs["ip"] = ip_answer("ERROR-ACTIVE", 0, 100);
  EXPECT_EQ(can0().level, Level::kOk);
  EXPECT_THAT(can0().found, StartsWith("500000 bit/s, ERROR-ACTIVE"));
  machine_.programs["ip"] = ip_answer("ERROR-PASSIVE", 128, 100);
  EXPECT_EQ(can0().level, Level::kWarning);
  machine_.programs["ip"] = ip_answer("BUS-OFF", 248, 100);
  EXPECT_EQ(can0().level, Level::kProblem);
  EXPECT_EQ(can0().fix, "sudo ip link set can0 down && sudo ip link set can0 up");
  machine_.programs["ip"] = "not JSON";
  EXPECT_EQ(can0().level, Level::kWarning);
  machine_.programs["ip"] = R"([{"flags":[]}])";
  EXPECT_THAT(can0().found, HasSubstr("down"));
}

/// A wrong bit rate disturbs the bus. The kernel keeps that of an interface that is down.
TEST_F(DoctorTest, KeepsTheBitRateOfAnInterfaceThatIsDown) {
  const auto fix_of = [this](const std::string& kind, const std::string& timing) {
    machine_.programs["ip"] = R"([{"flags":["NOARP"],"linkinfo":{"info_kind":")" + kind +
                              R"(","info_data":{"state":"STOPPED","restart_ms":0)" + timing +
                              "}}}]";
    return can0().fix;
  };
  EXPECT_EQ(fix_of("can", R"(,"bittiming":{"bitrate":250000})"), "sudo ip link set can0 up");
  EXPECT_EQ(fix_of("vcan", ""), "sudo ip link set can0 up");
  const std::string unknown = fix_of("can", "");
  EXPECT_THAT(unknown,
              StartsWith("sudo ip link set can0 up type can bitrate BITRATE restart-ms 100"));
  EXPECT_THAT(unknown, HasSubstr("vehicle"));
}

TEST_F(DoctorTest, WarnsOfAControllerThatStaysOff) {
  machine_.programs["ip"] = ip_answer("ERROR-ACTIVE", 0, 0);
  const Findings findings = check_can_interface(machine_, socketcan_config("can0"));
  EXPECT_THAT(findings.back().found, HasSubstr("restart-ms 0"));
  EXPECT_THAT(findings.back().fix, HasSubstr("restart-ms 100"));
}

/// A controller's settings do not help an Ethernet interface, and taking it down cuts the
/// connection.
TEST_F(DoctorTest, RefusesAnInterfaceThatIsNoCanInterface) {
  machine_.put("/sys/class/net/can0/type", "1\n");
  machine_.programs["ip"] = R"([{"flags":["UP"]}])";
  const Findings findings = check_can_interface(machine_, socketcan_config("can0"));
  EXPECT_EQ(findings.back().level, Level::kProblem);
  EXPECT_THAT(findings.back().found, HasSubstr("no CAN interface"));
  for (const Finding& finding : findings) EXPECT_THAT(finding.fix, Not(HasSubstr("down")));
}

TEST_F(DoctorTest, JudgesStateAndRestartOnlyOfAController) {
  const auto findings = [this](const std::string& kind) {
    machine_.programs["ip"] = R"([{"flags":["UP"],"linkinfo":{"info_kind":")" + kind + R"("}}])";
    return check_can_interface(machine_, socketcan_config("can0"));
  };
  for (const char* kind : {"vcan", "vxcan"}) {
    EXPECT_EQ(worst_of(findings(kind)), Level::kOk) << kind;
    EXPECT_THAT(findings(kind).back().found, HasSubstr("virtual"));
  }
  // As the older drivers of serial lines, which show no settings.
  EXPECT_EQ(worst_of(findings("")), Level::kOk);
}

TEST_F(DoctorTest, NamesAMissingInterface) {
  const Findings findings = check_can_interface(machine_, socketcan_config("vcan3"));
  EXPECT_EQ(findings.back().level, Level::kProblem);
  EXPECT_THAT(findings.back().fix, HasSubstr("ip link add vcan3 type vcan"));
}

TEST_F(DoctorTest, ComparesTheLimitsWithWhatIsConfigured) {
  firmware::Config config;
  EXPECT_EQ(worst_of(check_realtime(machine_, config)), Level::kOk);
  config.realtime.lock_memory = true;
  config.realtime.can.fifo_priority = 30;
  machine_.process_limits = {.realtime_priority = 20, .locked_memory_bytes = 65536};
  const Findings refused = check_realtime(machine_, config);
  ASSERT_EQ(refused.size(), 2U);
  EXPECT_THAT(refused[0].fix, HasSubstr("--rtprio=30"));
  EXPECT_THAT(refused[1].found, HasSubstr("65536"));
  machine_.process_limits = {.realtime_priority = 30, .locked_memory_bytes = std::nullopt};
  EXPECT_EQ(worst_of(check_realtime(machine_, config)), Level::kOk);
}

TEST_F(DoctorTest, LooksForEveryConfiguredCamera) {
  firmware::Config config;
  config.cameras.driver = firmware::CameraDriver::kV4l2;
  for (int i = 0; i < kCameraCount; ++i)
    config.cameras.devices.ids[i] = "Camera " + std::to_string(i);
  machine_.put("/sys/class/video4linux/video0/name", "Camera 0\n");
  machine_.put("/sys/class/video4linux/video0/index", "0\n");
  machine_.put("/dev/video0", "");
  const Findings findings = check_devices(machine_, config);
  ASSERT_EQ(findings.size(), 7U);  // the module, then the cameras
  EXPECT_EQ(findings[1].level, Level::kOk) << findings[1].found;
  for (size_t i = 2; i < 7; ++i) EXPECT_EQ(findings[i].level, Level::kProblem);
  machine_.permitted = false;
  EXPECT_THAT(check_devices(machine_, config)[1].fix, StartsWith("sudo usermod -aG video"));
}

TEST_F(DoctorTest, LooksForTheCamerasOfLibcamera) {
  firmware::Config config;
  config.cameras.driver = firmware::CameraDriver::kLibcamera;
  for (int i = 0; i < kCameraCount; ++i) {
    config.cameras.devices.ids[i] = "/base/cam" + std::to_string(i);
  }
  machine_.camera_ids = {"/base/cam0"};
  const Findings findings = check_devices(machine_, config);
  ASSERT_EQ(findings.size(), 6U);
  EXPECT_EQ(findings[0].level, Level::kOk);
  EXPECT_EQ(findings[1].level, Level::kProblem);
  EXPECT_THAT(findings[1].found, HasSubstr("/base/cam1"));
}

TEST_F(DoctorTest, ReadsTheRecordingsOfReplay) {
  firmware::Config config;
  config.cameras.driver = firmware::CameraDriver::kReplay;
  config.cameras.recording = machine_.real("/drive");
  machine_.put("/drive/front_left/frames.txt", "0 1000 0.png\n");
  machine_.put("/drive/front_left/0.png", "an image");
  const Findings findings = check_devices(machine_, config);
  ASSERT_EQ(findings.size(), 6U);
  EXPECT_EQ(findings[0].level, Level::kOk) << findings[0].found;
  EXPECT_EQ(findings[1].level, Level::kProblem);
  EXPECT_THAT(findings[1].found, HasSubstr("drive/front/frames.txt"));
  EXPECT_THAT(findings[1].wanted, HasSubstr("a picture folder in cameras.recording"));
}

TEST_F(DoctorTest, LooksForTheConfiguredGpioLines) {
  firmware::Config config;
  config.gpio.status_led = drivers::LineAddress{"soc", "LED"};
  config.gpio.fault = drivers::LineAddress{"expander", "FAULT"};
  EXPECT_THAT(check_devices(machine_, config).front().found, HasSubstr("no /dev/gpiochip*"));
  machine_.put("/dev/gpiochip0", "");
  machine_.chips = {{"gpiochip0", "soc", {{"LED", ""}, {"KL15", ""}}}};
  const Findings findings = check_devices(machine_, config);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].level, Level::kOk) << findings[0].found;
  EXPECT_EQ(findings[1].level, Level::kProblem) << "a usable chip is not that of the fault line";
  EXPECT_THAT(findings[1].found, HasSubstr("expander"));
  machine_.permitted = false;
  config.file = "/etc/my config.yaml";
  const Finding refused = check_devices(machine_, config).front();
  EXPECT_THAT(refused.fix, StartsWith("sudo bevloc udev-rules --config '/etc/my config.yaml' "
                                      "--out /etc/udev/rules.d/60-bevloc.rules && "));
  // Afterwards the group may open the chips, and this user is not in it.
  EXPECT_THAT(refused.fix, HasSubstr("sudo usermod -aG bevloc $USER"));
}

TEST_F(DoctorTest, JudgesMemoryDiskAndClock) {
  machine_.put("/proc/meminfo", "MemTotal: 4000000 kB\nMemAvailable: 1000000 kB\n");
  EXPECT_EQ(worst_of(check_room(machine_)), Level::kOk);
  EXPECT_EQ(check_room(machine_).front().found, "976 MiB available");
  machine_.put("/proc/meminfo", "MemAvailable: 1000 kB\n");
  machine_.free = 1000;
  EXPECT_EQ(check_room(machine_)[0].level, Level::kProblem);
  EXPECT_EQ(check_room(machine_)[1].level, Level::kWarning);
  EXPECT_EQ(check_clock(machine_).front().level, Level::kOk);
  machine_.synchronous = false;
  EXPECT_EQ(check_clock(machine_).front().level, Level::kWarning);
}

TEST_F(DoctorTest, ReadsTheStateOfTheUnit) {
  const auto findings = [this](const std::string& active, const std::string& file) {
    machine_.programs["systemctl"] = "LoadState=loaded\nActiveState=" + active +
                                     "\nSubState=x\nUnitFileState=" + file + "\nNRestarts=2\n";
    return check_unit(machine_);
  };
  EXPECT_EQ(check_unit(machine_).front().level, Level::kWarning);  // no systemd
  EXPECT_EQ(worst_of(findings("active", "enabled")), Level::kOk);
  EXPECT_EQ(worst_of(findings("failed", "enabled")), Level::kProblem);
  EXPECT_EQ(findings("active", "disabled").back().fix, "sudo systemctl enable bevlocd");
  machine_.programs["systemctl"] = "LoadState=not-found\n";
  EXPECT_THAT(check_unit(machine_).front().found, HasSubstr("no bevlocd.service"));
  EXPECT_THAT(check_unit(machine_).front().fix, HasSubstr("apt install ./bevloc_*.deb"))
      << "the unit alone lacks its user and its program";
}

TEST_F(DoctorTest, TellsWhyAUnitThatIsThereIsNotLoaded) {
  const auto finding = [this](const std::string& state) {
    machine_.programs["systemctl"] = "LoadState=" + state + "\nActiveState=inactive\n";
    return check_unit(machine_).front();
  };
  EXPECT_EQ(finding("masked").level, Level::kWarning);
  EXPECT_EQ(finding("masked").fix, "sudo systemctl unmask bevlocd");
  for (const char* state : {"bad-setting", "error"}) {
    EXPECT_EQ(finding(state).level, Level::kProblem);
    EXPECT_THAT(finding(state).found, HasSubstr(state));
    EXPECT_EQ(finding(state).fix, "systemd-analyze verify bevlocd.service");
  }
}

TEST_F(DoctorTest, JudgesWhatTheCamerasOfTheRigShow) {
  firmware::Config config;
  config.file = "/etc/bevlocd.yaml";
  config.rig_file = machine_.real("/rig.yaml");
  const auto rig_finding = [&](double down_deg) {
    machine_.put("/rig.yaml", format_rig(test::turned_down(test::demo_rig(), down_deg)));
    return check_files(config).front();
  };
  EXPECT_EQ(rig_finding(0.0).level, Level::kOk);
  const Finding warning = rig_finding(30.0);
  EXPECT_EQ(warning.level, Level::kWarning);
  EXPECT_THAT(warning.found, HasSubstr("below the horizon (front_left 35 %,"));
  EXPECT_THAT(warning.fix, StartsWith("bevloc eval rig " + config.rig_file.string()));
  const Finding problem = rig_finding(40.0);
  EXPECT_EQ(problem.level, Level::kProblem);
  EXPECT_EQ(problem.fix, "bevlocd --config /etc/bevlocd.yaml --check-config");
}

TEST_F(DoctorTest, AConfigurationWithAMistakeIsAProblem) {
  machine_.put("/bad.yaml", "cameras: {driver: v4l2}\n");
  const Findings findings = examine(machine_, machine_.real("/bad.yaml"), nullptr);
  EXPECT_EQ(findings.front().level, Level::kProblem);
  EXPECT_THAT(findings.front().found, HasSubstr("cameras.ids"));
  EXPECT_EQ(examine(machine_, "", nullptr).front().fix, "bevloc init");
}

TEST(Findings, AreWrittenAsTextAndJson) {
  const Findings findings{ok("cpu", "AVX2"),
                          {Level::kProblem, "can0", "found it", "that", "do it"}};
  EXPECT_EQ(to_text(findings),
            "ok       cpu   AVX2\n"
            "problem  can0  found it; wanted that\n"
            "               fix: do it\n"
            "2 checks: 1 ok, 0 warnings, 1 problems\n");
  const auto json = nlohmann::json::parse(to_json(findings));
  EXPECT_EQ(json["worst"], "problem");
  EXPECT_EQ(json["findings"][1]["fix"], "do it");
  EXPECT_FALSE(json["findings"][0].contains("fix"));
}

}  // namespace
}  // namespace bevloc::command
