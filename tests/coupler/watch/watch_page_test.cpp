// What the page of a run is told, and the clients that its server answers.
#include "coupler/watch/web/server.hpp"
#include "proto/error.hpp"
#include "tests/coupler/watch/page_fixture.hpp"

#include <gtest/gtest.h>
#include <httplib.h>  // last: it brings resolv.h, whose macro _res is a name of Eigen's

#include <arpa/inet.h>
#include <atomic>
#include <chrono>
#include <netinet/in.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace strake::watch {
namespace watch_page_test {

TEST_F(PageOfARun, TellsWhatTheFilesHold) {
  const Json run = json("api/run");
  EXPECT_EQ(run["title"], "a plate");
  EXPECT_EQ(run["spacing"], 0.1);
  EXPECT_EQ(run["probes"], Json::array({"mid"}));
  EXPECT_EQ(run["palette"]["water"].size() % 3, 0U);
  const Json news = json("api/news");
  EXPECT_EQ(news["state"], "killed");
  EXPECT_EQ(news["window"], 8);
  EXPECT_EQ(news["end_time"], 0.01);
  EXPECT_EQ(news["tables"]["history"]["rows"], 8);
  EXPECT_EQ(news["frames"]["fluid"]["count"], 1);
  EXPECT_EQ(news["stages"][0]["name"], "fluid.pressure");
  EXPECT_EQ(json("api/frames", {{"side", "fluid"}, {"from", "0"}})["times"], Json::array({0.5}));
}

TEST_F(PageOfARun, GivesRowsFromWhereTheyAreAskedFor) {
  const Read all(api.answer("api/table", {{"name", "history"}, {"from", "0"}}).body);
  EXPECT_EQ(all.head["columns"][8]["name"], "mid.y");
  EXPECT_EQ(all.head["columns"][8]["unit"], "m");
  EXPECT_EQ(all.head["columns"][3]["logarithmic"], true);
  EXPECT_EQ(all.array<double>("0"), (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8}));
  const Read more(api.answer("api/table", {{"name", "history"}, {"from", "6"}}).body);
  EXPECT_EQ(more.array<double>("0"), (std::vector<double>{7, 8}));
  EXPECT_EQ(more.head["rows"], 8);
  const Read beyond(api.answer("api/table", {{"name", "history"}, {"from", "99"}}).body);
  EXPECT_TRUE(beyond.array<double>("0").empty());
  EXPECT_EQ(beyond.head["from"], 8);
}

TEST_F(PageOfARun, GivesAParticleByItsPlaceOrItsNumber) {
  const Json by_place = json("api/point", {{"side", "fluid"}, {"number", "0"}, {"index", "1"}});
  EXPECT_EQ(by_place["values"][0]["value"], (Json{1, 0, 0}));
  const Json by_id = json("api/point", {{"side", "fluid"}, {"number", "0"}, {"id", "5"}});
  EXPECT_EQ(by_id, by_place);
}

TEST_F(PageOfARun, GivesWholeLinesOfALog) {
  const Json first = json("api/log", {{"name", "coupler"}, {"from", "-1"}});
  EXPECT_EQ(first["text"], "one\ntwo\n");
  EXPECT_EQ(first["to"], 8);
  put(files.path() / "coupler.log", "ne\n", true);
  const Json next = json("api/log", {{"name", "coupler"}, {"from", "8"}});
  EXPECT_EQ(next["text"], "half a line\n");
  EXPECT_EQ(next["begins"], false);
  put(files.path() / "coupler.log", "new\n");  // another run
  EXPECT_EQ(json("api/log", {{"name", "coupler"}, {"from", "20"}})["begins"], true);
  EXPECT_EQ(json("api/log", {{"name", "fluid"}, {"from", "-1"}})["text"], "");
}

TEST_F(PageOfARun, RefusesQuestionsThatAreNone) {
  EXPECT_EQ(status("api/nothing"), 404);
  EXPECT_EQ(status("../run.json"), 404);
  EXPECT_EQ(status("case.toml"), 404);
  EXPECT_EQ(status("api/table"), 400);
  EXPECT_EQ(status("api/table", {{"name", "history"}}), 400);
  EXPECT_EQ(status("api/table", {{"name", "../run"}, {"from", "0"}}), 400);
  EXPECT_EQ(status("api/table", {{"name", "history"}, {"from", "-1"}}), 400);
  EXPECT_EQ(status("api/table", {{"name", "history"}, {"from", "1e3"}}), 400);
  EXPECT_EQ(status("api/table", {{"name", "history"}, {"from", "99999999999999999999"}}), 400);
  EXPECT_EQ(status("api/frame", {{"side", "both"}, {"number", "0"}}), 400);
  EXPECT_EQ(status("api/frame", {{"side", "fluid"}, {"number", "17"}}), 404);
  EXPECT_EQ(status("api/frame", {{"side", "structure"}, {"number", "0"}}), 404);
  EXPECT_EQ(status("api/point", {{"side", "fluid"}, {"number", "0"}, {"index", "4"}}), 400);
  EXPECT_EQ(status("api/point", {{"side", "fluid"}, {"number", "0"}, {"id", "1234"}}), 404);
  EXPECT_EQ(status("api/log", {{"name", "../../etc/passwd"}, {"from", "0"}}), 400);
}

TEST(HostIsOurs, AdmitsWhatWasBoundAndNoNameOfOthers) {
  EXPECT_TRUE(host_is_ours("127.0.0.1:80", "127.0.0.1", 80));
  EXPECT_TRUE(host_is_ours("127.0.0.1", "127.0.0.1", 80));
  EXPECT_TRUE(host_is_ours("LocalHost:8137", "127.0.0.1", 8137));
  EXPECT_TRUE(host_is_ours("[::1]:8137", "127.0.0.1", 8137));
  EXPECT_FALSE(host_is_ours("localhost:8138", "127.0.0.1", 8137));
  EXPECT_FALSE(host_is_ours("localhost", "127.0.0.1", 8137));
  EXPECT_FALSE(host_is_ours("evil.example:8137", "127.0.0.1", 8137));
  EXPECT_FALSE(host_is_ours("127.0.0.1.evil.example:8137", "127.0.0.1", 8137));
  EXPECT_FALSE(host_is_ours("10.0.0.7:8137", "127.0.0.1", 8137));
  EXPECT_FALSE(host_is_ours("", "127.0.0.1", 8137));
  EXPECT_FALSE(host_is_ours("[::1", "127.0.0.1", 8137));
  EXPECT_TRUE(host_is_ours("10.0.0.7:8137", "0.0.0.0", 8137));
  EXPECT_FALSE(host_is_ours("evil.example:8137", "0.0.0.0", 8137));
}

class Served : public PageOfARun {
 protected:
  Served() : server(api, {.bind = "127.0.0.1", .port = 0, .token = "0123456789abcdef"}) { server.start(); }
  httplib::Client client() const { return httplib::Client("127.0.0.1", server.port()); }
  Server server;
};

TEST_F(Served, AnswersWhoKnowsTheToken) {
  auto page = client().Get("/0123456789abcdef/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_NE(page->body.find("<!doctype html>"), std::string::npos);
  EXPECT_NE(page->get_header_value("Content-Security-Policy").find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(page->get_header_value("Cache-Control"), "no-store");
  EXPECT_EQ(client().Get("/0123456789abcdef/api/news")->status, 200);
  EXPECT_EQ(client().Get("/0123456789abcdef/api/table?name=history&from=2")->status, 200);
  EXPECT_EQ(client().Head("/0123456789abcdef/page.js")->status, 200);
  EXPECT_EQ(client().Get("/0123456789abcdef")->status, 302);  // the page's own files are searched beside it
  EXPECT_EQ(server.address(), fmt::format("http://127.0.0.1:{}/0123456789abcdef/", server.port()));
}

TEST_F(Served, AnswersNobodyElse) {
  for (const char* path :
       {"/", "/page.js", "/api/news", "/0123456789abcdeX/", "/0123456789abcde/",
        "/0123456789abcdef0/api/news", "/../0123456789abcdeg/", "/favicon.ico", "//0123456789abcdef/"}) {
    const auto answer = client().Get(path);
    ASSERT_TRUE(answer) << path;
    EXPECT_EQ(answer->status, 403) << path;
    EXPECT_NE(answer->body.find("holds no valid token"), std::string::npos) << path;
    EXPECT_EQ(answer->body.find("0123456789abcdef"), std::string::npos) << path;
  }
}

TEST_F(Served, IsReachedByNoOtherName) {
  const auto answer =
      client().Get("/0123456789abcdef/api/news", {{"Host", fmt::format("evil.example:{}", server.port())}});
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 403);
  EXPECT_NE(answer->body.find("not served under that name"), std::string::npos);
}

TEST_F(Served, OnlyShows) {
  for (const auto& answer :
       {client().Post("/0123456789abcdef/api/news"), client().Delete("/0123456789abcdef/")}) {
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 405);
  }
}

/// What comes back on a plain connection.
std::string raw(int port, const std::string& request) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
  EXPECT_EQ(connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(write(socket, request.data(), request.size()), static_cast<ssize_t>(request.size()));
  shutdown(socket, SHUT_WR);
  std::string answer;
  char buffer[4096];
  for (ssize_t n = 0; (n = read(socket, buffer, sizeof buffer)) > 0;)
    answer.append(buffer, static_cast<std::size_t>(n));
  close(socket);
  return answer;
}

TEST_F(Served, OutlivesRequestsThatAreNone) {
  for (const std::string& request :
       {std::string("\r\n\r\n"), std::string("GET\r\n\r\n"), std::string("GET /%zz HTTP/1.1\r\n\r\n"),
        std::string(100'000, 'A'),
        std::string("GET /0123456789abcdef/%2e%2e/run.json HTTP/1.1\r\nHost: x\r\n\r\n"),
        std::string("\x00\xff\x16\x03\x01", 5)})
    EXPECT_EQ(raw(server.port(), request).find("HTTP/1.1 200"), std::string::npos);
  EXPECT_EQ(client().Get("/0123456789abcdef/api/news")->status, 200);
}

/// Connections that begin a request and do not end it; with `trickle` each sends a byte now and then.
class HalfRequests {
 public:
  HalfRequests(int port, int number, bool trickle) {
    for (int i = 0; i < number; ++i) {
      const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_port = htons(static_cast<std::uint16_t>(port));
      inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
      EXPECT_EQ(connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
      const std::string half = "GET /api/news HTTP/1.1\r\nHost: ";
      EXPECT_EQ(write(socket, half.data(), half.size()), static_cast<ssize_t>(half.size()));
      sockets_.push_back(socket);
    }
    if (trickle) thread_ = std::thread([this] { drip(); });
  }
  ~HalfRequests() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
    for (const int socket : sockets_) close(socket);
  }

 private:
  void drip() {
    while (!over_) {
      for (const int socket : sockets_) send(socket, "x", 1, MSG_NOSIGNAL | MSG_DONTWAIT);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  std::vector<int> sockets_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

TEST_F(Served, AnswersWithinASecondWhile200HalfRequestsStand) {
  for (const bool trickle : {false, true}) {
    const HalfRequests crowd(server.port(), 200, trickle);
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 3; ++i) {
      const auto answer = client().Get("/0123456789abcdef/api/news");
      ASSERT_TRUE(answer) << trickle;
      EXPECT_EQ(answer->status, 200);
    }
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1)) << trickle;
  }
}

TEST_F(Served, SaysThatAPortIsTaken) {
  try {
    Server second(api, {.bind = "127.0.0.1", .port = server.port(), .token = "t"});
    FAIL() << "two servers on one port";
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), fmt::format("--port {}", server.port()));
    EXPECT_EQ(error.code(), ExitCode::command_line);
  }
  EXPECT_THROW(Server(api, {.bind = "203.0.113.9", .port = 0, .token = "t"}), Error);
}

}  // namespace watch_page_test
}  // namespace strake::watch
