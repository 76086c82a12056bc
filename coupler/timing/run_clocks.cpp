#include "coupler/timing/run_clocks.hpp"

#include "proto/files/json_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <fcntl.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace strake {

namespace fs = std::filesystem;

RunClocks::RunClocks(fs::path run_folder, const Options& options)
    : folder_(std::move(run_folder)), options_(options) {}

void RunClocks::open() {
  if (!options_.trace) return;
  const fs::path path = folder_ / "trace.json";
  std::error_code none;
  for (int part = 1; options_.resumed && fs::exists(path, none); ++part) {
    const fs::path earlier = folder_ / fmt::format("trace-{}.json", part);
    if (!fs::exists(earlier, none)) fs::rename(path, earlier, none);
    if (none) break;
  }
  trace_.emplace(path);
}

std::function<void(const Exchange&)> RunClocks::observer() {
  if (!trace_ && !options_.profile) return {};
  return [this](const Exchange& exchange) {
    if (trace_) trace_->add(exchange);
    if (options_.profile) profile_.add(exchange);
  };
}

void RunClocks::end_window(const CommittedWindow& window, std::int64_t begin, std::int64_t end) {
  const std::int64_t files_end = Trace::now(), files = files_end - end;
  if (trace_) trace_->add("files", end, files_end);
  if (trace_)
    trace_->end_window(window.number, window.time, window.report.iterations, window.report.converged, begin,
                       end);
  if (options_.profile) profile_.end_window(window.report, begin, end, end + files);
}

namespace {

constexpr std::int64_t most_held = 1 << 16;              // [bytes]
constexpr std::int64_t longest_held = 50 * 1000 * 1000;  // [ns]
constexpr std::int64_t page = 4096;                      // [bytes] or a part of one, where they are larger
constexpr std::int64_t first_size = 16 * page;           // [bytes]
constexpr std::string_view closing = "\n]\n";
constexpr int coupler = 1;  // the tracks of a trace: process and thread numbers
constexpr int windows_row = 1, first_await_row = 2;

/// All of the text, or false.
bool write_at(int file, std::string_view text, std::int64_t at) {
  while (!text.empty()) {
    const ssize_t done = ::pwrite(file, text.data(), text.size(), at);
    if (done <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(done));
    at += done;
  }
  return true;
}

/// The first `size` bytes of a file.
bool copy(int from, int to, std::int64_t size) {
  std::array<char, 1 << 16> some{};
  for (std::int64_t at = 0; at < size;) {
    const auto wanted = std::min<std::int64_t>(size - at, static_cast<std::int64_t>(some.size()));
    const ssize_t got = ::pread(from, some.data(), static_cast<std::size_t>(wanted), at);
    if (got <= 0 || !write_at(to, {some.data(), static_cast<std::size_t>(got)}, at)) return false;
    at += got;
  }
  return true;
}

}  // namespace

Trace::Trace(const std::filesystem::path& path) : Trace(path, Limits()) {}

Trace::Trace(const std::filesystem::path& path, const Limits& limits)
    : limits_(limits), path_(path), zero_(now()) {
  replace(first_size);
  name_row(coupler, windows_row, "coupler", "windows and files");
  flush();
}

Trace::~Trace() {
  flush();
  if (file_ < 0) return;
  replace(written_ + static_cast<std::int64_t>(closing.size()));
  ::close(file_);
}

/// Replaces the file by one of that size, with its events, blanks and the closing bracket. If that fails, the
/// present file stays unchanged.
bool Trace::replace(std::int64_t size) {
  const std::string aside = path_.string() + ".part";
  const int fresh = ::open(aside.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fresh < 0) return false;
  const bool first = file_ < 0;
  const std::int64_t kept = first ? 1 : written_;
  std::string rest(static_cast<std::size_t>(size - kept) - closing.size(), ' ');
  rest += closing;
  if (!(first ? write_at(fresh, "[", 0) : copy(file_, fresh, kept)) || !write_at(fresh, rest, kept) ||
      std::rename(aside.c_str(), path_.c_str()) != 0) {
    ::close(fresh);
    ::unlink(aside.c_str());
    return false;
  }
  if (!first) ::close(file_);
  file_ = fresh;
  size_ = size;
  written_ = kept;
  return true;
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
  add_event(fmt::format(R"({{"name":"process_name",{}{{"name":{}}}}})", row, json_text(process_name)));
  add_event(fmt::format(R"({{"name":"thread_name",{}{{"name":{}}}}})", row, json_text(thread_name)));
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
  const std::int64_t at = begin - zero_, lasts = end - begin;  // nanoseconds, written as microseconds
  add_event(
      fmt::format(R"({{"name":"{}","ph":"X","pid":{},"tid":{},"ts":{}.{:03},"dur":{}.{:03},"args":{{{}}}}})",
                  name, process, thread, at / 1000, at % 1000, lasts / 1000, lasts % 1000, arguments));
}

/// One event per line, each within one page.
void Trace::add_event(const std::string& event) {
  if (static_cast<std::int64_t>(held_.size()) > most_held) flush();
  std::int64_t at = written_ + static_cast<std::int64_t>(held_.size());
  const std::string text = (at > 1 ? ",\n" : "\n") + event;
  const auto length = static_cast<std::int64_t>(text.size());
  if (length > page) return;
  if (at % page + length > page) held_.append(static_cast<std::size_t>(page - at % page), ' ');
  held_ += text;
}

void Trace::flush() {
  flushed_ = now();
  if (held_.empty()) return;
  const std::int64_t end = written_ + static_cast<std::int64_t>(held_.size());
  std::int64_t size = size_;
  while (size < end + static_cast<std::int64_t>(closing.size())) size = std::max(2 * size, first_size);
  bool good = file_ >= 0 && (size == size_ || replace(size));
  for (std::string_view rest = held_; good && !rest.empty();) {
    const auto piece = rest.substr(0, static_cast<std::size_t>(page - written_ % page));
    good = write_at(file_, piece, written_);
    if (good) written_ += static_cast<std::int64_t>(piece.size());
    rest.remove_prefix(piece.size());
  }
  held_.clear();
  if (good || file_ < 0) return;
  ::close(file_);  // a full disk: what stands there is left alone
  file_ = -1;
}

}  // namespace strake
