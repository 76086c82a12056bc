#include "coupler/trace.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <iterator>
#include <nlohmann/json.hpp>

namespace strake {
namespace {

constexpr std::int64_t most_held = 1 << 16;              // [bytes]
constexpr std::int64_t longest_held = 50 * 1000 * 1000;  // [ns]
constexpr const char* closing = "\n]\n";
constexpr int coupler = 1;  // the rows of a trace: process and thread numbers
constexpr int windows_row = 1, first_await_row = 2;

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

Trace::Trace(const std::filesystem::path& path) : Trace(path, Limits()) {}

Trace::Trace(const std::filesystem::path& path, const Limits& limits) : limits_(limits), zero_(now()) {
  file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  held_ = "[";
  name_row(coupler, windows_row, "coupler", "windows and files");
  flush();
}

Trace::~Trace() {
  flush();
  if (file_ >= 0) ::close(file_);
}

std::int64_t Trace::now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

Trace::Side& Trace::side(const std::string& name) {
  const auto [found, fresh] = sides_.try_emplace(name);
  if (fresh) {
    found->second.process = coupler + static_cast<int>(sides_.size());
    name_row(found->second.process, 1, name, "solver");
    name_row(coupler, first_await_row + found->second.process, "coupler", "awaits " + name);
  }
  return found->second;
}

void Trace::name_row(int process, int thread, const std::string& process_name,
                     const std::string& thread_name) {
  const std::string row = fmt::format(R"("ph":"M","pid":{},"tid":{},"args":)", process, thread);
  begin_event();
  held_ += fmt::format(R"({{"name":"process_name",{}{{"name":{}}}}})", row, quoted(process_name));
  begin_event();
  held_ += fmt::format(R"({{"name":"thread_name",{}{{"name":{}}}}})", row, quoted(thread_name));
}

void Trace::add(const Exchange& exchange) {
  Side& side = this->side(exchange.participant);
  side.clock.learn(exchange);
  const bool in_window = exchange.iteration != 0;
  if (in_window && !recording_) {
    side.idle_since = 0;  // it computed meanwhile
    return;
  }
  const ClockOffset::Span computing = side.clock.computing(exchange);
  const std::string place =
      in_window ? fmt::format(R"("window":{},"iteration":{})", exchange.window, exchange.iteration) : "";
  if (side.idle_since != 0 && computing.begin > side.idle_since)
    slice(side.process, 1, "waits", side.idle_since, computing.begin, "");
  side.idle_since = computing.end;
  slice(side.process, 1, exchange.asked, computing.begin, computing.end, place);
  slice(coupler, first_await_row + side.process, exchange.asked, exchange.sent, exchange.heard, place);
  if (exchange.heard - flushed_ > longest_held) flush();
}

void Trace::add(const std::string& what, std::int64_t begin, std::int64_t end) {
  if (recording_) slice(coupler, windows_row, what, begin, end, "");
}

void Trace::end_window(long number, double time, int iterations, bool converged, std::int64_t begin,
                       std::int64_t end) {
  if (recording_)
    slice(coupler, windows_row, fmt::format("window {}", number), begin, end,
          fmt::format(R"("time [s]":{:.9g},"iterations":{},"converged":{})", time, iterations, converged));
  const std::int64_t size = written_ + static_cast<std::int64_t>(held_.size());
  if (size - octave_begin_ > limits_.octave) {
    octave_begin_ = size;
    every_ *= 2;
  }
  recording_ = number % every_ == 0 && size < limits_.most;
}

void Trace::slice(int process, int thread, const std::string& name, std::int64_t begin, std::int64_t end,
                  const std::string& arguments) {
  begin_event();
  const std::int64_t at = begin - zero_, lasts = end - begin;  // nanoseconds, written as microseconds
  fmt::format_to(std::back_inserter(held_),
                 R"({{"name":"{}","ph":"X","pid":{},"tid":{},"ts":{}.{:03},"dur":{}.{:03},"args":{{{}}}}})",
                 name, process, thread, at / 1000, at % 1000, lasts / 1000, lasts % 1000, arguments);
}

/// One event per line.
void Trace::begin_event() {
  if (static_cast<std::int64_t>(held_.size()) > most_held) flush();
  held_ += held_.size() > 1 || written_ > 1 ? ",\n" : "\n";
}

void Trace::flush() {
  flushed_ = now();
  if (held_.empty()) return;
  if (file_ < 0) return held_.clear();
  const std::string text = held_ + closing;
  const ssize_t done = ::pwrite(file_, text.data(), text.size(), written_);
  if (done != static_cast<ssize_t>(text.size())) {  // a full disk: what stands there is closed and left alone
    [[maybe_unused]] const ssize_t ignored =
        ::pwrite(file_, closing, std::char_traits<char>::length(closing), written_);
    [[maybe_unused]] const int cut = ::ftruncate(file_, written_ + 3);
    ::close(file_);
    file_ = -1;
    return held_.clear();
  }
  written_ += static_cast<std::int64_t>(held_.size());
  held_.clear();
}

}  // namespace strake
