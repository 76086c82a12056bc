#include "coupler/commands/commands.hpp"
#include "coupler/console/console.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/participant/stop_request.hpp"
#include "coupler/watch/text_view.hpp"
#include "coupler/watch/web/http_api.hpp"
#include "coupler/watch/web/server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

namespace strake {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto terminal_interval = 500ms;
constexpr auto pipe_refresh = 500ms;
constexpr auto pipe_interval = 5s;  // between two lines

/// Takes the whole screen of a terminal, and gives it back as it was when it is destroyed.
class WholeScreen {
 public:
  WholeScreen() {
    keys_ = ::isatty(STDIN_FILENO) != 0 && ::tcgetattr(STDIN_FILENO, &before_) == 0 &&
            ::tcgetpgrp(STDIN_FILENO) == ::getpgrp();
    if (keys_) {
      termios raw = before_;
      raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
      raw.c_cc[VMIN] = 0;
      raw.c_cc[VTIME] = 0;
      ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
    }
    put("\033[?1049h\033[?25l");  // the other screen, no cursor
  }
  ~WholeScreen() {
    put("\033[?25h\033[?1049l");
    if (keys_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  WholeScreen(const WholeScreen&) = delete;
  WholeScreen& operator=(const WholeScreen&) = delete;

  void draw(const std::vector<std::string>& lines) {
    std::string text = "\033[H";
    for (std::size_t k = 0; k < lines.size(); ++k)
      text += lines[k] + "\033[K" + (k + 1 < lines.size() ? "\r\n" : "");
    put(text + "\033[J");
  }
  /// Waits; whether the reader wants to leave.
  bool leaves(std::chrono::milliseconds limit) {
    if (!keys_) {
      ::poll(nullptr, 0, static_cast<int>(limit.count()));
      return false;
    }
    pollfd keyboard{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    if (::poll(&keyboard, 1, static_cast<int>(limit.count())) <= 0) return false;
    char key = 0;
    while (::read(STDIN_FILENO, &key, 1) == 1)
      if (key == 'q' || key == 'Q' || key == 4) return true;         // 4: Ctrl-D
    if ((keyboard.revents & (POLLHUP | POLLERR)) != 0) return true;  // the terminal is gone
    return false;
  }

 private:
  static void put(const std::string& text) { strake::put(stdout, text); }
  termios before_{};
  bool keys_ = false;
};

watch::Screen screen_now() {
  const Style style = style_of(stdout);
  watch::Screen screen{.width = style.width > 0 ? style.width : 80, .height = 24, .colour = style.colour};
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0) screen.height = size.ws_row;
  return screen;
}

ExitCode code_of(const watch::RunStatus& status) {
  if (status.state == watch::State::killed) return ExitCode::participant_lost;
  return static_cast<ExitCode>(status.exit_code.value_or(0));
}

/// On a terminal: the view in place; the last one stays there when all is over.
ExitCode on_terminal(watch::WatchedRun& run, const StopRequest& stop) {
  bool left = false;
  if (watch::open(run.update().state)) {
    WholeScreen screen;
    while (watch::open(run.last().state) && !left && !stop.requested()) {
      watch::Screen now = screen_now();
      now.height -= 1;
      std::vector<std::string> lines = watch::screen_lines(run, now);
      lines.push_back(painted({.colour = now.colour}, "2", "q ends watching; the run goes on"));
      screen.draw(lines);
      left = screen.leaves(std::chrono::duration_cast<std::chrono::milliseconds>(terminal_interval));
      run.update();
    }
  }
  watch::Screen now = screen_now();
  now.height = std::max(8, now.height - 2);
  for (const std::string& line : watch::screen_lines(run, now)) fmt::print("{}\n", line);
  if (stop.requested()) return stop.code();
  return left ? ExitCode::done : code_of(run.last());
}

/// In a pipe: a line now and then, the last when the run ends.
ExitCode in_pipe(watch::WatchedRun& run, const StopRequest& stop) {
  watch::PlainLines lines(stdout);
  run.update();
  lines.begin(run);
  auto said = Clock::now() - pipe_interval;
  while (watch::open(run.last().state) && !stop.requested()) {
    if (Clock::now() - said >= pipe_interval) {
      lines.more(run);
      said = Clock::now();
    }
    ::poll(nullptr, 0,
           static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(pipe_refresh).count()));
    run.update();
    if (std::ferror(stdout) != 0) return ExitCode::done;  // nobody reads any more
  }
  lines.end(run);
  return stop.requested() ? stop.code() : code_of(run.last());
}

/// Serves the page until Ctrl-C; a run that has ended can still be inspected.
ExitCode on_page(const WatchOptions& options, const std::filesystem::path& folder, const StopRequest& stop) {
  watch::HttpApi api(folder);
  watch::Server server(api, {.bind = options.bind, .port = options.port, .token = random_token()});
  server.start();
  fmt::print("{}\n  {}\n", folder.string(), server.address());
  if (!watch::is_loopback(options.bind))
    fmt::print(
        "  warning: other machines can reach this page, unencrypted; whoever has the address sees the run. "
        "Over ssh instead: leave out --bind, and\n");
  if (!watch::is_loopback(options.bind) || std::getenv("SSH_CONNECTION") != nullptr)
    fmt::print("  on your own machine: ssh -L {0}:127.0.0.1:{0} HOST, then open the address there\n",
               server.port());
  fmt::print("  Ctrl-C ends watching; the run goes on\n");
  std::fflush(stdout);
  while (!stop.requested()) ::poll(nullptr, 0, 200);
  server.stop();
  return ExitCode::done;
}

}  // namespace

ExitCode watch_run(const WatchOptions& options, const StopRequest& stop) {
  const std::filesystem::path folder = options.run.empty() ? watch::newest_run(options.runs) : options.run;
  if (options.web) return on_page(options, folder, stop);
  watch::WatchedRun run(folder);
  return style_of(stdout).terminal ? on_terminal(run, stop) : in_pipe(run, stop);
}

}  // namespace strake
