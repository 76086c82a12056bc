#include "coupler/processes/log_tail.hpp"

#include "coupler/participant/long_log.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <ctime>
#include <deque>
#include <fstream>
#include <string_view>

namespace strake {
namespace {

const std::string information = "] [info] ", resumed = information + "resumed at window ";

/// Whether one of several ranks says in that line why it ends.
bool is_of_rank(const std::string& line) {
  return line.starts_with("rank ") && line.size() > 5 && std::isdigit(static_cast<unsigned char>(line[5]));
}

/// Whether a line says nothing of an error: it is empty, a rule of a launcher (dashes), or information.
bool says_nothing(const std::string& line) {
  return line.find_first_not_of('-') == std::string::npos || line.find(information) != std::string::npos;
}

}  // namespace

void note_resume(const std::filesystem::path& log, long window) {
  const auto now = std::chrono::system_clock::now();
  const auto part = std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()) % 1000;
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  std::tm local{};
  localtime_r(&seconds, &local);
  std::ofstream(log, std::ios::app) << fmt::format("[{}.{:03}{}{}\n", time_text("%Y-%m-%d %H:%M:%S", local),
                                                   part.count(), resumed, window);
}

namespace {

/// The last lines of a log, and the last of them in which ranks say why they end.
struct LastLines {
  std::deque<std::string> lines, of_ranks;
};

LastLines last_lines(const std::filesystem::path& log) {
  constexpr std::size_t most = 3, longest = 2000;  // lines, characters of one
  std::ifstream file(log);
  LastLines last;
  // The part of a long log that is always there.
  const auto kept = static_cast<std::streamoff>(LogBounds{}.last);
  file.seekg(0, std::ios::end);
  const std::streamoff size = file.tellg();
  file.seekg(std::max<std::streamoff>(0, size - kept));
  auto& [lines, of_ranks] = last;
  for (std::string line; std::getline(file, line);) {
    if (line.find(resumed) != std::string::npos) {
      lines.clear();
      of_ranks.clear();
    }
    if (says_nothing(line)) continue;
    for (auto* list : {&lines, &of_ranks}) {
      if (list == &of_ranks && !is_of_rank(line)) continue;
      list->push_back(line.size() > longest ? "... " + line.substr(line.size() - longest) : line);
      if (list->size() > most) list->pop_front();
    }
  }
  return last;
}

}  // namespace

bool has_words_of_ranks(const std::filesystem::path& log) {
  return !last_lines(log).of_ranks.empty();
}

std::string log_tail(const std::filesystem::path& log) {
  const auto [lines, of_ranks] = last_lines(log);
  std::string text;
  for (const std::string& line : of_ranks.empty() ? lines : of_ranks)
    text += "\n" + log.filename().string() + ": " + line;
  return text;
}

std::string missing_module(const std::filesystem::path& log) {
  constexpr std::string_view mark = "ModuleNotFoundError: No module named '";
  constexpr std::array<std::array<std::string_view, 2>, 4> packages{{{"numpy", "python3-numpy"},
                                                                     {"zmq", "python3-zmq"},
                                                                     {"google", "python3-protobuf"},
                                                                     {"scipy", "python3-scipy"}}};
  for (const std::string& line : last_lines(log).lines) {
    if (!line.starts_with(mark)) continue;
    const std::string name = line.substr(mark.size(), line.find('\'', mark.size()) - mark.size());
    std::string fix = fmt::format(
        "its Python has no module {}: the program's first line (#!) chooses which Python that is", name);
    for (const auto& [module, package] : packages)
      if (name.substr(0, name.find('.')) == module)
        fix += fmt::format("; #!/usr/bin/python3 is Debian's, with {} from {}", module, package);
    return fix + "; ";
  }
  return {};
}

}  // namespace strake
