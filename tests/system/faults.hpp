#pragma once

#include "coupler/participant/launch.hpp"
#include "coupler/processes/remote.hpp"
#include "proto/error.hpp"
#include "tests/proto/temporary_folder.hpp"
#include "tests/text/golden.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <signal.h>
#include <sys/wait.h>
#include <thread>

namespace strake {

inline std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

inline std::filesystem::path folder_of(const std::string& endpoint) {
  return std::filesystem::path(endpoint.substr(6)).parent_path();
}

/// Whether the process exists; a zombie has ended.
inline bool runs(pid_t pid) {
  const std::string stat = content(fmt::format("/proc/{}/stat", pid));
  const std::size_t name_end = stat.rfind(')');
  return name_end != std::string::npos && stat[name_end + 2] != 'Z';
}

/// Participants and their toys as processes, in a folder of their own. Nothing may be left when a test is
/// over.
class Faults : public testing::Test {
 protected:
  void SetUp() override {
    options_.say = [this](const std::string& line) { said_ += line + "\n"; };
    options_.case_hash.fill(0x2a);
  }
  void TearDown() override {
    EXPECT_FALSE(std::filesystem::exists(folder_of(endpoint_))) << "the socket's folder is left behind";
    EXPECT_NE(waitpid(-1, nullptr, WNOHANG), 0) << "a process is left behind";
  }

  Participants& participants() {
    if (!participants_) {
      participants_ = std::make_unique<Participants>(options_);
      endpoint_ = participants_->endpoint();
    }
    return *participants_;
  }
  std::filesystem::path log(const std::string& name) const { return folder_ / (name + ".log"); }
  void launch(const std::string& name, const std::string& fault, int at = 1) {
    participants().launch(name, {std::filesystem::path(STRAKE_TOYS) / "toy_participant",
                                 {"--fault", fault, "--at", std::to_string(at)},
                                 log(name),
                                 1,
                                 {}});
  }
  /// One that the coupler waits for and does not own.
  Child by_hand(const std::string& name, const std::string& fault) {
    participants().attach(name);
    std::string hash;
    for (int i = 0; i < 32; ++i) hash += "2a";
    return Child({std::filesystem::path(STRAKE_TOYS) / "toy_participant",
                  {"--connect", endpoint_, "--name", name, "--fault", fault, "--case-hash", hash},
                  log(name),
                  1,
                  {{"STRAKE_TOKEN", participants().token()}}});
  }
  pid_t pid_of(const std::string& name) const {
    const std::string text = content(log(name));
    const std::size_t at = text.find("process ");
    return at == std::string::npos ? 0 : static_cast<pid_t>(std::stol(text.substr(at + 8)));
  }
  void wait_for(const std::filesystem::path& file, const std::string& text) const {
    for (int i = 0; i < 1000 && content(file).find(text) == std::string::npos; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  /// The error that `act` ends with; the coupler's work is over when this returns, everything is ended.
  Error error_of(const std::function<void()>& act) {
    std::optional<Error> error;
    try {
      act();
    } catch (const Error& e) {
      error = e;
    }
    participants_.reset();
    if (!error) {
      ADD_FAILURE() << "no error";
      return {ExitCode::done, "", ""};
    }
    fmt::print("{}{}", said_, to_text(*error));
    expect_stored("faults.txt", this_test(),
                  without_chance(said_ + to_text(*error), folder_.path().string()));
    return *error;
  }
  /// Sends a signal to a participant once it is inside its step.
  std::thread signal_inside_step(const std::string& name, int number) {
    return std::thread([this, name, number] {
      wait_for(log(name), "step begins");
      signalled_ = std::chrono::steady_clock::now();
      kill(pid_of(name), number);
    });
  }
  double delay() const {  // [s] since the signal
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - signalled_).count();
  }
  void report_delay() const {
    fmt::print("{:.3f} s after the signal\n", delay());
    RecordProperty("seconds_after_the_signal", fmt::format("{:.3f}", delay()));
  }

  Participants::Options options_;
  TemporaryFolder folder_;
  std::string said_, endpoint_;
  std::unique_ptr<Participants> participants_;
  std::chrono::steady_clock::time_point signalled_;
};

}  // namespace strake
