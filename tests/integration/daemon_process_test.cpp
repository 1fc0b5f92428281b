// bevlocd as a process whose log nobody reads, and which is sent signals.
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/cameras.h"
#include "tests/firmware/runtime/fake_manager.h"
#include "tests/integration/bevlocd_process.h"

namespace bevloc::test {
namespace {

/// A pipe that accepts nothing more, because nobody reads it.
class FullPipe {
 public:
  FullPipe() {
    EXPECT_EQ(pipe2(ends_, O_NONBLOCK), 0);
    const std::string text(4096, 'x');
    while (write(ends_[1], text.data(), text.size()) > 0) {
    }
    EXPECT_EQ(fcntl(ends_[1], F_SETFL, 0), 0) << "the daemon's writes may block";
  }
  ~FullPipe() {
    close(ends_[0]);
    close(ends_[1]);
  }
  FullPipe(const FullPipe&) = delete;
  FullPipe& operator=(const FullPipe&) = delete;
  int writer() const { return ends_[1]; }

 private:
  int ends_[2] = {-1, -1};
};

class DaemonProcessTest : public testing::Test {
 protected:
  /// Recordings whose images cannot be read, so that nothing is rendered.
  DaemonProcessTest() {
    for (const std::string_view camera : kCameraNames) {
      const auto folder = scratch_ / std::string(camera);
      std::filesystem::create_directories(folder);
      write_file(folder / "frames.txt", "0 0 none.png\n");
      write_file(folder / "none.png", "");
    }
    const std::filesystem::path root = BEVLOC_SOURCE_DIR;
    write_file(config_, "cameras: {driver: replay, recording: .}\ncalibration: {rig: " +
                            (root / "config/rig_demo.yaml").string() + "}\nmap: {file: " +
                            (root / "tests/pipeline/map/fixtures/street.osm").string() +
                            "}\nmodel: {file: " + (root / "models/nano.onnx").string() +
                            "}\ncan: {driver: mock}\n");
  }

  /// Starts bevlocd with this stdout and stderr; closed ones if negative.
  void start(int output) {
    process_ = fork();
    ASSERT_GE(process_, 0);
    if (process_ != 0) return;
    for (const int file : {STDOUT_FILENO, STDERR_FILENO}) {
      if (output >= 0) {
        dup2(output, file);
      } else {
        close(file);
      }
    }
    execl(BEVLOCD_PROGRAM, BEVLOCD_PROGRAM, "--config", config_.c_str(), nullptr);
    _exit(127);
  }

  /// Waits until the service manager was sent `text`. False if the process ended before.
  bool wait_for(const std::string& text) {
    while (messages_.find(text) == std::string::npos) {
      if (process_ <= 0) return false;
      if (waitpid(process_, nullptr, WNOHANG) != 0) {
        process_ = -1;
        return false;
      }
      messages_ += manager_.all();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    messages_.clear();
    return true;
  }

  /// Sends SIGTERM and returns the exit code; -1 if the process had ended before.
  int terminate() {
    if (process_ <= 0) return -1;
    kill(process_, SIGTERM);
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  TemporaryFolder scratch_;
  std::filesystem::path config_ = scratch_ / "config.yaml";
  firmware::FakeManager manager_;
  std::string messages_;
  pid_t process_ = -1;
};

TEST_F(DaemonProcessTest, AFullPipeBlocksNeitherStartNorSupervisionNorEnd) {
  const FullPipe pipe;
  start(pipe.writer());
  EXPECT_TRUE(wait_for("READY=1"));
  for (int feeds = 0; feeds < 5; ++feeds) EXPECT_TRUE(wait_for("WATCHDOG=1"));
  EXPECT_EQ(terminate(), 0);
}

TEST_F(DaemonProcessTest, AClosedStdoutBlocksNothing) {
  start(-1);
  EXPECT_TRUE(wait_for("READY=1"));
  EXPECT_TRUE(wait_for("WATCHDOG=1"));
  EXPECT_EQ(terminate(), 0);
}

TEST_F(DaemonProcessTest, AHangupDoesNotEndIt) {
  const int log = open((scratch_ / "log").c_str(), O_CREAT | O_WRONLY, 0600);
  start(log);
  close(log);
  EXPECT_TRUE(wait_for("READY=1"));
  kill(process_, SIGHUP);
  for (int feeds = 0; feeds < 3; ++feeds) EXPECT_TRUE(wait_for("WATCHDOG=1"));
  EXPECT_EQ(terminate(), 0);
  EXPECT_NE(read_text(scratch_ / "log").find("SIGHUP ignored"), std::string::npos);
}

}  // namespace
}  // namespace bevloc::test
