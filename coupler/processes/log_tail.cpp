#include "coupler/processes/log_tail.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <deque>
#include <fstream>

namespace strake {
namespace {

const std::string information = "] [info] ", resumed = information + "resumed at window ";

}  // namespace

void note_resume(const std::filesystem::path& log, long window) {
  const auto now = std::chrono::system_clock::now();
  const auto part = std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()) % 1000;
  std::ofstream(log, std::ios::app) << fmt::format("[{:%Y-%m-%d %H:%M:%S}.{:03}{}{}\n",
                                                   fmt::localtime(std::chrono::system_clock::to_time_t(now)),
                                                   part.count(), resumed, window);
}

std::string log_tail(const std::filesystem::path& log) {
  constexpr std::size_t most = 3;
  std::ifstream file(log);
  std::deque<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    if (line.find(resumed) != std::string::npos) lines.clear();
    if (!line.empty() && line.find(information) == std::string::npos) lines.push_back(line);
    if (lines.size() > most) lines.pop_front();
  }
  std::string text;
  for (const std::string& line : lines) text += "\n" + log.filename().string() + ": " + line;
  return text;
}

}  // namespace strake
