// Tests the HTTP server with good, slow, huge, malformed and too many requests.
#include "firmware/live/http_server.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <future>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include "common/file_descriptor.h"
#include "firmware/live/httplib_header.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr int kPatience_ms = 20000;

/// A client that sends bytes as they are.
class RawClient {
 public:
  explicit RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ =
        connect(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  }

  bool connected() const { return connected_; }
  void send(const std::string& text) const {
    ::send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL);
  }

  /// All that the server sends until it closes the connection.
  std::string receive() const {
    std::string text;
    std::array<char, 4096> part{};
    pollfd ready{socket_.get(), POLLIN, 0};
    while (poll(&ready, 1, kPatience_ms) > 0) {
      const ssize_t size = recv(socket_.get(), part.data(), part.size(), 0);
      if (size <= 0) return text;
      text.append(part.data(), static_cast<size_t>(size));
    }
    ADD_FAILURE() << "the server did not close the connection";
    return text;
  }

 private:
  FileDescriptor socket_;
  bool connected_ = false;
};

class HttpServerTest : public testing::Test {
 protected:
  void start(const HttpLimits& limits = {}) {
    auto opened = HttpServer::open("127.0.0.1", 0, limits);
    ASSERT_TRUE(opened) << opened.error().message;
    server_ = std::move(*opened);
    server_->set_headers({{"X-Test", "yes"}});
    server_->get("/", [](const httplib::Request&, httplib::Response& response) {
      response.set_content("hello", "text/plain");
    });
    server_->start();
  }

  std::string answer_to(const std::string& request) const {
    const RawClient client(server_->port());
    EXPECT_TRUE(client.connected());
    client.send(request);
    return client.receive();
  }
  std::string get(const std::string& target) const {
    return answer_to("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  void expect_alive() const { EXPECT_THAT(get("/"), StartsWith("HTTP/1.1 200")); }

  static size_t threads() {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return static_cast<size_t>(std::distance(begin(tasks), end(tasks)));
  }

  std::unique_ptr<HttpServer> server_;
};

TEST_F(HttpServerTest, AnswersWithItsHeaders) {
  start();
  const std::string answer = get("/");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(answer, HasSubstr("X-Test: yes\r\n"));
  EXPECT_THAT(answer, HasSubstr("\r\n\r\nhello"));
}

TEST_F(HttpServerTest, RefusesAPortThatIsTaken) {
  start();
  const auto second = HttpServer::open("127.0.0.1", server_->port());
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("wanted a free port"));
}

TEST_F(HttpServerTest, RefusesAnAddressOfAnotherMachine) {
  const auto server = HttpServer::open("192.0.2.1", 0);
  ASSERT_FALSE(server);
  EXPECT_THAT(server.error().message, StartsWith("live: found no way to listen at 192.0.2.1"));
}

TEST_F(HttpServerTest, LeavesNoPathToTheFilesOfTheMachine) {
  start();
  for (const char* target :
       {"/../../../../etc/passwd", "/%2e%2e/%2e%2e/%2e%2e/etc/passwd", "//etc/passwd",
        "/..%5c..%5cetc/passwd", "/page.css/../../etc/passwd", "file:///etc/passwd"}) {
    const std::string answer = get(target);
    EXPECT_THAT(answer, testing::Not(HasSubstr("root:"))) << target;
    EXPECT_THAT(answer, testing::Not(StartsWith("HTTP/1.1 200"))) << target;
  }
  expect_alive();
}

TEST_F(HttpServerTest, RefusesOtherMethods) {
  start();
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "PATCH"}) {
    const std::string answer = answer_to(std::string(method) +
                                         " / HTTP/1.1\r\nHost: localhost\r\n"
                                         "Content-Length: 1000000000\r\n\r\n");
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 405")) << method;
  }
  expect_alive();
}

TEST_F(HttpServerTest, RefusesForeignHostNames) {
  start();
  for (const char* host : {"Host: evil.example\r\n", "Host: localhost.evil.example:80\r\n", "",
                           "Host: localhost\r\nHost: evil.example\r\n", "Host: [::1\r\n"}) {
    EXPECT_THAT(answer_to(fmt::format("GET / HTTP/1.1\r\n{}\r\n", host)),
                StartsWith("HTTP/1.1 403"))
        << host;
  }
  for (const char* host : {"localhost", "127.0.0.1:8080", "[::1]:8080", "192.168.1.7"}) {
    EXPECT_THAT(answer_to(fmt::format("GET / HTTP/1.1\r\nHost: {}\r\n\r\n", host)),
                StartsWith("HTTP/1.1 200"))
        << host;
  }
}

TEST_F(HttpServerTest, SurvivesMalformedRequests) {
  HttpLimits limits;
  limits.request = milliseconds(300);
  start(limits);
  const std::string zeros(100, '\0');
  for (const std::string& request :
       {std::string("\r\n\r\n"), std::string("GET\r\n\r\n"), std::string("GET / HTTP/9.9\r\n\r\n"),
        zeros + "\r\n\r\n", std::string("\x16\x03\x01\x02\x00\x01 tls\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nno colon\r\n\r\n"),
        std::string("GET /%zz%00 HTTP/1.1\r\nHost: localhost\r\n\r\n"),
        std::string("GET / HTTP/1.1\nHost: localhost\n\n"),
        std::string("GET / HTTP/1.1\r\nHost: localhost\r\nRange: bytes=9-1,-,a\r\n\r\n")}) {
    const RawClient client(server_->port());
    client.send(request);
    client.receive();
  }
  expect_alive();
}

TEST_F(HttpServerTest, EndsHugeRequests) {
  start();
  const std::string huge(1 << 20, 'a');
  for (const std::string& request :
       {"GET /" + huge + " HTTP/1.1\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: localhost\r\nX: " + huge + "\r\n\r\n", huge}) {
    EXPECT_THAT(answer_to(request), testing::Not(StartsWith("HTTP/1.1 200")));
  }
  std::string many = "GET / HTTP/1.1\r\nHost: localhost\r\n";
  for (int i = 0; i < 10000; ++i) many += fmt::format("X-{}: a\r\n", i);
  EXPECT_THAT(answer_to(many + "\r\n"), testing::Not(StartsWith("HTTP/1.1 200")));
  expect_alive();
}

TEST_F(HttpServerTest, AnswersOnceHoweverManyRangesARequestNames) {
  start();
  for (const std::string range : {"0-", "1-3", "-"}) {
    std::string request = "GET / HTTP/1.1\r\nHost: localhost\r\nRange: bytes=" + range;
    while (request.size() < 8000) request += "," + range;
    const std::string answer = answer_to(request + "\r\n\r\n");
    EXPECT_LT(answer.size(), 1000u) << range;
  }
  EXPECT_THAT(answer_to("GET / HTTP/1.1\r\nHost: localhost\r\nRange: bytes=1-\r\n\r\n"),
              testing::AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("\r\n\r\nhello")));
}

TEST_F(HttpServerTest, ClosesConnectionsThatSayNothing) {
  HttpLimits limits;
  limits.idle = milliseconds(20);
  start(limits);
  const RawClient client(server_->port());
  EXPECT_THAT(client.receive(), IsEmpty());
}

TEST_F(HttpServerTest, EndsSlowRequestsAndAnswersOthersMeanwhile) {
  HttpLimits limits;
  limits.workers = 2;
  limits.request = milliseconds(300);
  start(limits);
  const RawClient slow(server_->port());
  slow.send("GET / HTTP/1.1\r\nHost: loc");
  expect_alive();
  EXPECT_THAT(slow.receive(), testing::Not(StartsWith("HTTP/1.1 200")));
  expect_alive();
}

TEST_F(HttpServerTest, SlowRequestsOnEveryWorkerEnd) {
  HttpLimits limits;
  limits.workers = 2;
  limits.request = milliseconds(100);
  start(limits);
  std::vector<RawClient> slow;
  for (int i = 0; i < 6; ++i) slow.emplace_back(server_->port()).send("G");
  expect_alive();
}

TEST_F(HttpServerTest, EndsAClientThatDoesNotRead) {
  HttpLimits limits;
  limits.workers = 1;
  limits.write = milliseconds(100);
  auto opened = HttpServer::open("127.0.0.1", 0, limits);
  ASSERT_TRUE(opened) << opened.error().message;
  server_ = std::move(*opened);
  server_->get("/", [](const httplib::Request&, httplib::Response& response) {
    response.set_content("hello", "text/plain");
  });
  // The answer is larger than the buffers of both sockets.
  server_->get("/big", [](const httplib::Request&, httplib::Response& response) {
    response.set_content(std::string(16 << 20, 'a'), "text/plain");
  });
  server_->start();
  const RawClient client(server_->port());
  client.send("GET /big HTTP/1.1\r\nHost: localhost\r\n\r\n");
  expect_alive();  // with the only worker
}

TEST_F(HttpServerTest, SendsNotFarAheadOfAClientThatDoesNotRead) {
  HttpLimits limits;
  limits.write = milliseconds(100);
  auto opened = HttpServer::open("127.0.0.1", 0, limits);
  ASSERT_TRUE(opened) << opened.error().message;
  server_ = std::move(*opened);
  size_t sent_bytes = 0;
  std::promise<void> ended;
  server_->get("/events", [&](const httplib::Request&, httplib::Response& response) {
    const auto write = [&](size_t, httplib::DataSink& sink) {
      const std::string event(10'000, 'a');
      const bool taken = sink.write(event.data(), event.size());
      if (taken) sent_bytes += event.size();
      return taken;
    };
    response.set_chunked_content_provider("text/event-stream", write,
                                          [&](bool) { ended.set_value(); });
  });
  server_->start();
  const RawClient client(server_->port());
  client.send("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  ended.get_future().wait();
  EXPECT_GT(sent_bytes, 0U);
  EXPECT_LT(sent_bytes, 1'000'000U) << "events of minutes on a slow link";
}

/// CTest runs this suite in a process of its own. In that of HttpServerTest, the threads of an
/// earlier server may still be ending while the test counts threads.
class HttpServerThreadsTest : public HttpServerTest {};

TEST_F(HttpServerThreadsTest, StandsAThousandIdleConnections) {
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  if (files.rlim_max < 2000) GTEST_SKIP() << "found at most " << files.rlim_max << " open files";
  files.rlim_cur = std::max<rlim_t>(files.rlim_cur, 2000);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &files), 0);
  const size_t before = threads();
  start();
  const size_t with_server = threads();
  EXPECT_EQ(with_server, before + HttpLimits().workers + 1);
  std::vector<RawClient> idle;
  idle.reserve(1000);
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(idle.emplace_back(server_->port()).connected()) << i;
  }
  expect_alive();
  EXPECT_EQ(threads(), with_server);
}

TEST_F(HttpServerTest, StopsWhileClientsAreConnected) {
  start();
  const RawClient idle(server_->port());
  const RawClient slow(server_->port());
  slow.send("GET / HT");
  expect_alive();
  server_.reset();
  EXPECT_THAT(idle.receive(), IsEmpty());
}

}  // namespace
}  // namespace bevloc::firmware
