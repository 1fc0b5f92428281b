// Tests what the daemon's HTTP server answers without an appliance.
#include "firmware/live/live_server.h"

#include <atomic>
#include <deque>
#include <map>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command/status/status_command.h"
#include "firmware/live/http_server.h"
#include "firmware/live/httplib_header.h"
#include "tests/support/command_line.h"

namespace bevloc::firmware {
namespace {

using command::StatusCommand;
using testing::HasSubstr;

class LiveServerTest : public testing::Test {
 protected:
  void SetUp() override {
    LiveConfig config;
    config.port = 0;  // a free one; the configuration does not allow it
    auto started = LiveServer::start(config);
    ASSERT_TRUE(started) << started.error().message;
    server_ = std::move(*started);
  }

  httplib::Result get(const std::string& path) const {
    httplib::Client client("127.0.0.1", server_->port());
    return client.Get(path);
  }

  httplib::Result head(const std::string& path) const {
    httplib::Client client("127.0.0.1", server_->port());
    return client.Head(path);
  }

  void publish(HealthState state, WhyMask why = {}, bool valid = false) const {
    Telemetry telemetry;
    telemetry.phase = Phase::kRunning;
    telemetry.snapshot.estimation.state = state;
    telemetry.snapshot.estimation.why = why;
    telemetry.snapshot.estimation.pose.known = true;
    telemetry.snapshot.estimation.pose.valid = valid;
    server_->publish(telemetry);
  }

  /// The exit code of `bevloc status` with these arguments.
  int status(const std::vector<std::string>& arguments) const {
    return status_at(server_->port(), arguments);
  }
  static int status_at(int port, const std::vector<std::string>& arguments) {
    std::vector<std::string> words{"status", "--port", std::to_string(port)};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return test::run_command<StatusCommand>(words);
  }

  std::unique_ptr<LiveServer> server_;
};

TEST_F(LiveServerTest, ServesThePageWithoutForeignAddresses) {
  const std::map<std::string, std::string> types{{"/", "text/html; charset=utf-8"},
                                                 {"/page.css", "text/css; charset=utf-8"},
                                                 {"/page.js", "text/javascript; charset=utf-8"},
                                                 {"/match.js", "text/javascript; charset=utf-8"}};
  for (const auto& [path, type] : types) {
    const auto answer = get(path);
    ASSERT_TRUE(answer) << path;
    EXPECT_EQ(answer->status, 200) << path;
    EXPECT_EQ(answer->get_header_value("Content-Type"), type) << path;
    EXPECT_THAT(answer->body, testing::Not(testing::ContainsRegex("https?://"))) << path;
    EXPECT_THAT(answer->get_header_value("Content-Security-Policy"),
                HasSubstr("default-src 'none'"));
  }
}

TEST_F(LiveServerTest, SaysWhetherTheDaemonIsHealthy) {
  EXPECT_EQ(get("/healthz")->status, 200);  // it starts
  publish(HealthState::kTracking, {}, true);
  EXPECT_EQ(get("/healthz")->status, 200);
  publish(HealthState::kLost, Why::kOdometryMissing);
  const auto lost = get("/healthz");
  EXPECT_EQ(lost->status, 503);
  EXPECT_THAT(lost->body, HasSubstr("LOST: odometry missing: Check that wheel speed"));
}

TEST_F(LiveServerTest, SendsMetricsAndStatus) {
  publish(HealthState::kTracking, {}, true);
  EXPECT_THAT(get("/metrics")->body, HasSubstr("bevloc_state{state=\"TRACKING\"} 1"));
  const auto status = nlohmann::json::parse(get("/status.json")->body);
  EXPECT_EQ(status["state"], "TRACKING");
  EXPECT_EQ(status["valid"], true);
}

TEST_F(LiveServerTest, BevlocStatusReturnsWhetherThePoseIsValid) {
  publish(HealthState::kTracking, {}, true);
  EXPECT_EQ(status({}), StatusCommand::kValid);
  EXPECT_EQ(status({"--json"}), StatusCommand::kValid);
  publish(HealthState::kLost, Why::kOdometryMissing);
  EXPECT_EQ(status({}), StatusCommand::kNotValid);
}

TEST_F(LiveServerTest, BevlocStatusSaysThatNobodyAnswers) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(status({"--address", "127.0.0.2"}), StatusCommand::kNotReachable);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("found no bevlocd that answers"));
}

TEST_F(LiveServerTest, BevlocStatusEndsAlsoIfAnotherProgramSendsWithoutEnd) {
  auto other = HttpServer::open("127.0.0.1", 0);
  ASSERT_TRUE(other) << other.error().message;
  (*other)->get("/status.json", [](const httplib::Request&, httplib::Response& response) {
    response.set_chunked_content_provider("text/plain", [](size_t, httplib::DataSink& sink) {
      const std::string part(10'000, 'a');
      return sink.write(part.data(), part.size());
    });
  });
  (*other)->start();
  testing::internal::CaptureStderr();
  EXPECT_EQ(status_at((*other)->port(), {}), StatusCommand::kNotReachable);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("is another program there?"));
}

TEST_F(LiveServerTest, BevlocStatusTakesNoNameThatTheServerRefuses) {
  publish(HealthState::kTracking, {}, true);
  EXPECT_EQ(status({"--address", "localhost"}), StatusCommand::kValid);
  try {
    status({"--address", "vehicle.example"});
    FAIL() << "the name was accepted";
  } catch (const CLI::ValidationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("found 'vehicle.example', wanted an IP address in numbers, "
                                        "such as 127.0.0.1, or localhost"));
  }
}

TEST_F(LiveServerTest, RefusesTooManyViewersAndTakesThemAgainLater) {
  publish(HealthState::kTracking, {}, true);
  /// A viewer that reads events until it is told to end.
  struct Viewer {
    explicit Viewer(int port)
        : thread([this, port] {
            httplib::Client client("127.0.0.1", port);
            client.Get("/events", [this](const char*, size_t) {
              reads = true;
              reads.notify_all();
              return !end;
            });
          }) {}
    ~Viewer() { end = true; }
    std::atomic<bool> reads{false};
    std::atomic<bool> end{false};
    std::jthread thread;
  };
  // A client that asks without reading events is no viewer.
  for (int i = 0; i <= LiveServer::kViewers; ++i) EXPECT_EQ(head("/events")->status, 200);
  {
    std::deque<Viewer> viewers;
    for (int i = 0; i < LiveServer::kViewers; ++i) {
      viewers.emplace_back(server_->port()).reads.wait(false);
    }
    EXPECT_EQ(get("/events")->status, 503);
    EXPECT_EQ(head("/events")->status, 503);
    EXPECT_EQ(get("/healthz")->status, 200);
  }
  // The server notices with its next event that viewers have left. Until then it may refuse a new
  // one.
  int answer = 503;
  while (answer == 503) {
    httplib::Client client("127.0.0.1", server_->port());
    client.Get(
        "/events",
        [&answer](const httplib::Response& response) {
          answer = response.status;
          return true;
        },
        [](const char*, size_t) { return false; });
  }
  EXPECT_EQ(answer, 200);
}

}  // namespace
}  // namespace bevloc::firmware
