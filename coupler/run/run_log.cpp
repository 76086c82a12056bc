#include "coupler/run/run_log.hpp"

#include "coupler/console/console.hpp"
#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

namespace strake {

namespace {

/// The text of a line of the log.
class VisibleText final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& line) override {
    const std::string text = visible({message.payload.data(), message.payload.size()});
    line.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<VisibleText>(); }
};

}  // namespace

std::shared_ptr<spdlog::logger> open_run_log(const std::filesystem::path& path) {
  try {
    auto log = std::make_shared<spdlog::logger>(
        "coupler", std::make_shared<spdlog::sinks::basic_file_sink_st>(path.string()));
    auto format = std::make_unique<spdlog::pattern_formatter>();
    format->add_flag<VisibleText>('*').set_pattern("%Y-%m-%d %H:%M:%S.%e %l %*");
    log->set_formatter(std::move(format));
    log->flush_on(spdlog::level::info);
    log->set_error_handler([](const std::string&) {});  // a full disk is reported by the files that matter
    return log;
  } catch (const spdlog::spdlog_ex& error) {
    throw Error(ExitCode::cannot_write, path.string(), error.what(),
                "free space, or choose another folder with --runs DIR");
  }
}

void ConsoleLoss::look(spdlog::logger& log, const std::filesystem::path& path) {
  const int failure = console_failure();
  if (told_ || failure == 0) return;
  told_ = true;
  const std::string why = std::generic_category().message(failure);
  log.warn(fmt::format("the console cannot be written ({}); the run goes on without it", why));
  if (failure != EPIPE)  // a user who closed a pipe knows of it
    put(stderr, visible(fmt::format("strake: the console cannot be written ({}); the run goes on, see {}\n",
                                    why, path.string())));
}

std::string WaitLog::line(const Awaited& whom) {
  constexpr double interval = 10;      // [s]
  if (whom.waited < told_) told_ = 0;  // another answer
  if (whom.doing.empty() || whom.waited < told_ + interval) return {};
  told_ = whom.waited;
  return fmt::format("{}: {}, {:.0f} % after {:.0f} s", whom.name, whom.doing, 100 * whom.part, whom.waited);
}

}  // namespace strake
