#include "coupler/run/run_folder.hpp"
#include "coupler/timing/profile.hpp"
#include "coupler/timing/run_clocks.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <signal.h>
#include <sstream>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace strake {
namespace trace_test {

constexpr std::int64_t us = 1000;  // [ns]

std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// An exchange of 100 µs that begins at `sent`: 10 µs there, 80 µs of computing, 10 µs back. The
/// participant's clock is `ahead` of ours.
Exchange exchange(const std::string& who, std::int64_t sent, std::int64_t ahead = 0, long window = 1,
                  std::uint32_t iteration = 1) {
  return {.participant = who,
          .asked = "Advance",
          .window = window,
          .iteration = iteration,
          .sent = sent,
          .heard = sent + 100 * us,
          .received = sent + 10 * us + ahead,
          .answered = sent + 90 * us + ahead};
}

TEST(ClockOffset, IsZeroWhereTheTwoClocksMayBeOne) {
  ClockOffset clock;
  Exchange late = exchange("fluid", 1000 * us);
  late.received += 9 * us;  // woke up late: the middle of the bounds is not zero, but zero lies within
  clock.learn(late);
  EXPECT_EQ(clock.offset(), 0);
  EXPECT_EQ(clock.computing(late).begin, late.received);
  EXPECT_EQ(clock.computing(late).end, late.answered);
}

TEST(ClockOffset, OfAnotherMachineIsShutInByEveryExchange) {
  const std::int64_t ahead = 7'000'000'000;
  ClockOffset clock;
  for (int i = 0; i < 5; ++i) {
    Exchange e = exchange("fluid", i * 1000 * us, ahead);
    e.received += i * us;  // slower on some trips
    e.answered += i * us;
    clock.learn(e);
    EXPECT_NEAR(static_cast<double>(clock.offset()), static_cast<double>(ahead), 10.0 * us);
    const ClockOffset::Span span = clock.computing(e);
    EXPECT_GE(span.begin, e.sent);
    EXPECT_LE(span.end, e.heard);
    EXPECT_NEAR(static_cast<double>(span.end - span.begin), 80.0 * us, 10.0 * us);
  }
}

TEST(ClockOffset, FollowsAClockThatDriftsAway) {
  ClockOffset clock;
  clock.learn(exchange("fluid", 0, 1'000'000'000));
  clock.learn(exchange("fluid", 1000 * us, 1'000'500'000));
  EXPECT_NEAR(static_cast<double>(clock.offset()), 1'000'500'000.0, 10.0 * us);
}

TEST(ClockOffset, CountsTheWholeExchangeOfAParticipantThatTellsNoTimes) {
  ClockOffset clock;
  Exchange e = exchange("fluid", 1000 * us);
  e.received = e.answered = 0;
  clock.learn(e);
  EXPECT_EQ(clock.computing(e).begin, e.sent);
  EXPECT_EQ(clock.computing(e).end, e.heard);
}

/// Duration [µs] of the slices of that name in a process, and their number.
std::pair<double, int> slices(const nlohmann::json& trace, const std::string& process,
                              const std::string& name) {
  int id = 0;
  for (const auto& event : trace)
    if (event["name"] == "process_name" && event["args"]["name"] == process) id = event["pid"];
  std::pair<double, int> found;
  for (const auto& event : trace)
    if (event["ph"] == "X" && event["pid"] == id && event["name"] == name) {
      found.first += event["dur"].get<double>();
      ++found.second;
    }
  return found;
}

TEST(Trace, ShowsWhoComputedAndWhoWaited) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "trace.json";
  {
    Trace trace(path);
    const std::int64_t start = Trace::now();
    for (std::uint32_t i = 0; i < 3; ++i) {
      trace.add(exchange("fluid", start + i * 200 * us, 0, 1, i + 1));
      trace.add(exchange("structure", start + (i * 200 + 100) * us, 0, 1, i + 1));
    }
    trace.end_window(1, 1e-5, 3, true, start, start + 600 * us);
  }
  const auto trace = nlohmann::json::parse(text_of(path));
  for (const char* who : {"fluid", "structure"}) {
    EXPECT_EQ(slices(trace, who, "Advance").second, 3);
    EXPECT_NEAR(slices(trace, who, "Advance").first, 240, 0.01);
    EXPECT_EQ(slices(trace, who, "waits").second, 2);
    EXPECT_NEAR(slices(trace, who, "waits").first, 240, 0.01);
  }
  EXPECT_EQ(slices(trace, "coupler", "Advance").second, 6);
  EXPECT_NEAR(slices(trace, "coupler", "window 1").first, 600, 0.01);
}

/// `windows` windows of four exchanges each.
void fill(Trace& trace, long windows) {
  std::int64_t t = Trace::now();
  for (long n = 1; n <= windows; ++n) {
    const std::int64_t begin = t;
    for (int i = 0; i < 4; ++i, t += 100 * us)
      trace.add(exchange(i % 2 == 0 ? "fluid" : "structure", t, 0, n, static_cast<std::uint32_t>(i / 2 + 1)));
    trace.end_window(n, 1e-5 * static_cast<double>(n), 2, true, begin, t);
  }
}

TEST(Trace, ThinsOutAndStaysWithinItsSize) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "trace.json";
  const Trace::Limits limits{.octave = 20'000, .most = 100'000};
  {
    Trace trace(path, limits);
    fill(trace, 5000);
  }
  const std::string text = text_of(path);
  EXPECT_LT(static_cast<std::int64_t>(text.size()),
            limits.most + 2'000);  // the window under way is kept whole
  EXPECT_GT(static_cast<std::int64_t>(text.size()), limits.most - 2'000);
  std::vector<long> seen;
  for (const auto& event : nlohmann::json::parse(text))
    if (event["name"].get<std::string>().starts_with("window "))
      seen.push_back(std::stol(event["name"].get<std::string>().substr(7)));
  EXPECT_EQ(seen[1] - seen[0], 1);
  EXPECT_EQ(seen.back() - seen[seen.size() - 2], 16);
  for (const auto& event : nlohmann::json::parse(text))  // a window that is left out is no wait
    if (event["name"] == "waits") {
      EXPECT_LT(event["dur"].get<double>(), 250);
    }
}

TEST(Trace, IsValidAtEveryMomentOfItsWriting) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "trace.json";
  for (unsigned attempt = 0; attempt < 10; ++attempt) {
    std::filesystem::remove(path);
    const pid_t writer = fork();
    ASSERT_GE(writer, 0);
    if (writer == 0) {
      Trace trace(path);
      fill(trace, 1'000'000);
      _exit(0);
    }
    for (int wait = 0; wait < 20'000; ++wait, usleep(1000))  // blanks follow the events
      if (const auto events = text_of(path).rfind('}'); events != std::string::npos && events > 50'000) break;
    usleep(700 * attempt);  // somewhere in a record, or as the file grows
    kill(writer, SIGKILL);
    waitpid(writer, nullptr, 0);
    const auto trace = nlohmann::json::parse(text_of(path), nullptr, false);
    ASSERT_FALSE(trace.is_discarded()) << text_of(path).substr(text_of(path).size() - 300);
    EXPECT_GT(trace.size(), 100u);
  }
}

TEST(Trace, EndsWellFormedWhereNoMoreCanBeWritten) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "trace.json";
  const pid_t writer = fork();
  ASSERT_GE(writer, 0);
  if (writer == 0) {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{200'000, 200'000};  // bytes of one file: a full disk for those who may not mount one
    setrlimit(RLIMIT_FSIZE, &limit);
    Trace trace(path);
    fill(trace, 2'000);
    _exit(0);
  }
  int status = 0;
  waitpid(writer, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  const std::string text = text_of(path);
  EXPECT_GT(text.size(), 100'000u);
  EXPECT_LE(text.size(), 200'000u);
  EXPECT_FALSE(nlohmann::json::parse(text, nullptr, false).is_discarded());
}

TEST(Profile, TellsTheWallTimeApartWithoutRemainder) {
  Profile profile;
  const std::int64_t begin = 5000 * us;
  profile.add(exchange("fluid", begin + 10 * us));  // serial: one after the other
  profile.add(exchange("structure", begin + 120 * us));
  WindowReport report;
  report.iterations = 1;
  report.fluid["seconds.pressure"] = 60e-6;
  profile.end_window(report, begin, begin + 250 * us, begin + 300 * us);
  const Profile::Seconds& s = profile.seconds();
  EXPECT_NEAR(s.computing.at("fluid"), 80e-6, 1e-12);
  EXPECT_NEAR(s.computing.at("structure"), 80e-6, 1e-12);
  EXPECT_NEAR(s.together, 0, 1e-12);
  EXPECT_NEAR(s.messages, 40e-6, 1e-12);
  EXPECT_NEAR(s.coupler, 50e-6, 1e-12);
  EXPECT_NEAR(s.files, 50e-6, 1e-12);
  EXPECT_NEAR(s.total(), 300e-6, 1e-12);
  EXPECT_EQ(profile.lines().size(), 7u);
}

TEST(Profile, CountsTwoThatComputeAtOnceOnce) {
  Profile profile;
  profile.add(exchange("fluid", 1000 * us));
  profile.add(exchange("structure", 1040 * us));  // computes from 1050 to 1130, the fluid from 1010 to 1090
  profile.end_window({}, 1000 * us, 1200 * us, 1200 * us);
  EXPECT_NEAR(profile.seconds().together, 40e-6, 1e-12);
  EXPECT_NEAR(profile.seconds().messages, 20e-6, 1e-12);
  EXPECT_NEAR(profile.seconds().coupler, 60e-6, 1e-12);
  EXPECT_NEAR(profile.seconds().total(), 200e-6, 1e-12);
}

}  // namespace trace_test
}  // namespace strake
