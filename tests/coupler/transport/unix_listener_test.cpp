// An ipc endpoint removes only the socket of a dead run at its path, and nothing else.

#include "coupler/transport/unix_listener.hpp"

#include "coupler/transport/sockets.hpp"
#include "proto/error.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace strake {
namespace unix_listener_test {

namespace fs = std::filesystem;

class Listener : public testing::Test {
 protected:
  std::string path() const { return (place_ / "p").string(); }
  std::string lock() const { return path() + ".lock"; }
  static void write(const std::string& file, const std::string& text) { std::ofstream(file) << text; }

  /// A socket that is no run's; it listens while the descriptor is open.
  int foreign_socket() const {
    const int s = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path().data(), path().size());
    EXPECT_EQ(bind(s, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(listen(s, 1), 0);
    return s;
  }
  /// A run that ends without a word, as by SIGKILL.
  void dead_run() const {
    const pid_t child = fork();
    if (child == 0) {
      try {
        auto* listener = new UnixListener(path());
        _exit(listener->descriptor() >= 0 ? 0 : 1);
      } catch (const Error&) {
        _exit(1);
      }
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
    EXPECT_TRUE(fs::is_socket(path()));
  }
  std::string problem() const {
    try {
      const UnixListener listener(path());
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::command_line);
      EXPECT_EQ(e.where(), "coupling.endpoint = \"ipc://" + path() + "\"");
      EXPECT_FALSE(e.fix().empty());
      return e.problem();
    }
    return "";
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(place_.path())) all.push_back(entry.path().filename());
    std::sort(all.begin(), all.end());
    return all;
  }

  TemporaryFolder place_;
};

using Names = std::vector<std::string>;

TEST_F(Listener, AFileALinkAPipeAndAFolderStayAsTheyAre) {
  const fs::path target = place_ / "target";
  write(target, "mine");
  const std::vector<std::pair<std::string, std::function<void()>>> kinds{
      {"a file", [&] { write(path(), "x"); }},
      {"a link", [&] { fs::create_symlink(target, path()); }},
      {"a link", [&] { fs::create_symlink(place_ / "nowhere", path()); }},
      {"a pipe", [&] { mkfifo(path().c_str(), 0600); }},
      {"a folder", [&] { fs::create_directory(path()); }}};
  for (const auto& [kind, make] : kinds) {
    make();
    const auto before = fs::symlink_status(path()).type();
    EXPECT_EQ(problem(), "the path is taken: " + kind + " stands there");
    EXPECT_EQ(fs::symlink_status(path()).type(), before);
    EXPECT_EQ(names(), (Names{"p", "target"}));
    fs::remove(path());
  }
  EXPECT_EQ(content(target), "mine");
}

TEST_F(Listener, ASocketOfAnotherProgramStaysWhetherItLivesOrNot) {
  const int s = foreign_socket();
  EXPECT_EQ(problem(), "the path is taken: another program listens there");
  close(s);
  EXPECT_EQ(problem(), "the path is taken: a socket stands there that no run of Strake has left");
  EXPECT_EQ(names(), Names{"p"});
}

TEST_F(Listener, ASocketThatReplacedThatOfADeadRunStays) {
  dead_run();
  fs::remove(path());
  close(foreign_socket());
  EXPECT_EQ(problem(), "the path is taken: a socket stands there that no run of Strake has left");
  EXPECT_TRUE(fs::is_socket(path()));
}

TEST_F(Listener, TheSocketOfADeadRunIsReplacedAndNothingIsLeft) {
  dead_run();
  { const UnixListener listener(path()); }
  EXPECT_EQ(names(), Names{});
}

TEST_F(Listener, ASecondRunOnOnePathIsRefusedAndTheFirstGoesOn) {
  CouplerSocket first("ipc://" + path());
  EXPECT_EQ(problem(), "the path is taken: another run uses it");
  ParticipantSocket participant(first.endpoint());
  const std::string word = "word";
  participant.send({{std::as_bytes(std::span(word)), nullptr}});
  EXPECT_TRUE(first.receive(std::chrono::seconds(5)));
}

TEST_F(Listener, AFileOfTheUserBesideItIsNoLock) {
  for (const char* text : {"", "mine"}) {
    write(lock(), text);
    EXPECT_EQ(problem(), lock() + " stands beside it and is no lock of Strake");
    EXPECT_EQ(content(lock()), text);
  }
  fs::remove(lock());
  write(place_ / "target", "");
  fs::create_symlink(place_ / "target", lock());
  EXPECT_NE(problem(), "");
  EXPECT_EQ(content(place_ / "target"), "");
}

TEST_F(Listener, WhatReplacedOurSocketStaysWhenTheRunEnds) {
  {
    const UnixListener listener(path());
    fs::remove(path());
    write(path(), "mine");
  }
  EXPECT_EQ(content(path()), "mine");
  EXPECT_EQ(names(), Names{"p"});
}

TEST_F(Listener, AFolderThatIsMissingIsNamed) {
  try {
    const UnixListener listener((place_ / "none" / "p").string());
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.problem(),
              "the folder " + (place_ / "none").string() + "/ cannot be entered: No such file or directory");
  }
}

TEST_F(Listener, ANameWithoutAFileIsTakenOnce) {
  const std::string name = "@strake-test-" + std::to_string(getpid());
  const UnixListener listener(name);
  try {
    const UnixListener twin(name);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.problem(), "the path is taken: another program uses it");
  }
}

/// How many of eight runs that start at once get the path. Who has it keeps it until all have tried.
int winners(const std::string& path) {
  constexpr int runs = 8;
  int start[2], tried[2], end[2];
  if (pipe(start) != 0 || pipe(tried) != 0 || pipe(end) != 0) return -1;
  const auto wait_for_close = [](int pipe_end) {
    char byte = 0;
    return read(pipe_end, &byte, 1) == 0;
  };
  std::vector<pid_t> children;
  for (int i = 0; i < runs; ++i)
    if (const pid_t child = fork(); child == 0) {
      alarm(60);
      close(start[1]);
      close(end[1]);
      bool won = wait_for_close(start[0]);
      std::unique_ptr<UnixListener> listener;
      try {
        listener = std::make_unique<UnixListener>(path);
      } catch (const Error&) {
        won = false;
      }
      close(tried[1]);
      if (won) won = wait_for_close(end[0]);
      listener.reset();
      _exit(won ? 0 : 1);
    } else {
      children.push_back(child);
    }
  for (int fd : {start[0], start[1], tried[1]}) close(fd);
  const bool all_tried = wait_for_close(tried[0]);
  for (int fd : {tried[0], end[0], end[1]}) close(fd);
  int won = 0;
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    won += status == 0 ? 1 : 0;
  }
  return all_tried ? won : -1;
}

TEST_F(Listener, OfRunsThatStartAtOnceOneGetsThePath) {
  for (int i = 0; i < 3; ++i) EXPECT_EQ(winners(path()), 1);
  EXPECT_EQ(names(), Names{});
  dead_run();
  EXPECT_EQ(winners(path()), 1);
  EXPECT_EQ(names(), Names{});
}

}  // namespace unix_listener_test
}  // namespace strake
