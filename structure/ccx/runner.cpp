#include "structure/ccx/runner.hpp"

#include "coupler/participant/launch.hpp"
#include "coupler/participant/serve.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

namespace strake::structure::ccx {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* deck_name = "deck";
constexpr std::uintmax_t enough_space = 1
                                        << 20;  // bytes; less than that: the disk is why something is missing

/// The last lines of a log that are not empty.
std::string last_lines(const fs::path& log) {
  constexpr std::size_t n_lines = 12;
  std::ifstream stream(log);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);)
    if (line.find_first_not_of(" \r_*") != std::string::npos || line.find("*ERROR") != std::string::npos)
      lines.push_back(line);
  std::string text;
  for (std::size_t i = lines.size() - std::min(n_lines, lines.size()); i < lines.size(); ++i)
    text += "\n" + lines[i];
  return text.empty() ? "\nit said nothing" : text;
}

/// Increments that are done: CalculiX writes a line of its .sta file for each, below two of a heading.
std::size_t increments_done(const fs::path& file) {
  std::ifstream stream(file);
  std::size_t lines = 0;
  for (std::string line; std::getline(stream, line);) ++lines;
  return lines > 2 ? lines - 2 : 0;
}

/// The kernel ends CalculiX with us where there is setpriv (Debian: util-linux, in every system).
std::pair<fs::path, std::vector<std::string>> command(const fs::path& program) {
  const std::vector<std::string> arguments = {"-i", deck_name};
  try {
    const fs::path wrapper = find_program("setpriv");
    return {wrapper, {"--pdeathsig", "KILL", program.string(), arguments[0], arguments[1]}};
  } catch (const Error&) {
    return {program, arguments};
  }
}

}  // namespace

fs::path installed_program() {
  try {
    return find_program("ccx");
  } catch (const Error&) {
    throw Error(ExitCode::case_file, "structure.solver = \"ccx\"",
                "CalculiX is not installed: there is no program ccx on PATH",
                "apt install calculix-ccx, or structure.solver = \"fem\"");
  }
}

std::string installed_version() {
  const std::string text = capture(installed_program(), {"-v"}).out, before = "Version ";
  const std::size_t at = text.find(before);
  if (at == std::string::npos) return {};
  const std::size_t from = at + before.size();
  return text.substr(from, text.find_first_of(" \n", from) - from);
}

Runner::Runner(fs::path run_folder, const std::string& body, double answer_within)
    : own_folder_(run_folder.empty() ? fs::path() : run_folder / (body.empty() ? "ccx" : "ccx_" + body)),
      answer_within_(answer_within) {}

Runner::~Runner() {
  std::error_code ignored;
  if (!keep_ && !folder_.empty()) fs::remove_all(folder_, ignored);
}

void Runner::prepare() {
  if (!folder_.empty()) return;
  if (own_folder_.empty()) {
    std::string pattern = (fs::temp_directory_path() / "strake-ccx-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr)
      throw Error(ExitCode::cannot_write, pattern,
                  fmt::format("no temporary folder can be made: {}", std::strerror(errno)), "TMPDIR=FOLDER");
    folder_ = pattern;
    return;
  }
  std::error_code error;
  folder_ = own_folder_;
  fs::remove_all(folder_, error);  // of a run that was cut off
  fs::create_directories(folder_, error);
  if (error) throw Error(ExitCode::cannot_write, folder_.string(), error.message());
}

fs::path Runner::file(const std::string& extension) const {
  return folder_ / (std::string(deck_name) + "." + extension);
}

void Runner::write(const std::string& extension, const std::string& bytes) {
  std::ofstream stream(file(extension), std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream)
    throw Error(ExitCode::cannot_write, file(extension).string(), std::strerror(errno),
                "make room on the disk");
}

void Runner::fail(const std::string& what, const std::string& problem) {
  keep_ = true;
  std::error_code error;
  if (const fs::space_info space = fs::space(folder_, error); !error && space.available < enough_space)
    throw Error(ExitCode::cannot_write, folder_.string(),
                fmt::format("the disk is full, and CalculiX could not write what it computed ({})", what),
                "make room on the disk; strake run --resume goes on from the last checkpoint");
  throw Error(
      ExitCode::solver_fault, "structure (ccx), " + what,
      fmt::format("CalculiX {}; its last lines:{}", problem, last_lines(folder_ / "log")),
      fmt::format("its deck and output are kept in {}: ccx -i {}; lower coupling.surface.window, or look at "
                  "the load",
                  folder_.string(), deck_name));
}

void Runner::run(const std::string& deck, const std::string& restart, std::size_t increments,
                 const std::string& what) {
  prepare();
  std::error_code ignored;
  for (const char* old : {"dat", "frd", "sta", "cvg", "rout", "rin"}) fs::remove(file(old), ignored);
  write("inp", deck);
  if (!restart.empty()) write("rin", restart);

  const auto [program, arguments] = command(installed_program());
  Child child({.program = program,
               .arguments = arguments,
               .log = folder_ / "log",
               .threads = 1,
               .environment = {},
               .folder = folder_});
  const auto limit =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(answer_within_));
  auto last_progress = Clock::now();
  std::size_t done = 0;
  std::optional<Exit> exit;
  while (!(exit = child.wait(std::chrono::milliseconds(500)))) {
    const std::size_t now_done = increments_done(file("sta"));
    if (now_done > done) {
      done = now_done;
      last_progress = Clock::now();
    }
    working(static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(increments, 1)),
            "CalculiX computes " + what);
    if (Clock::now() - last_progress < limit) continue;
    child.end(std::chrono::milliseconds(200));
    fail(what, fmt::format("has not ended an increment within {:g} s (structure.ccx.answer_within)",
                           answer_within_));
  }
  if (exit->code != 0 || exit->signal != 0) fail(what, to_text(*exit));
}

std::string Runner::content(const std::string& extension, const std::string& what) {
  std::ifstream stream(file(extension), std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  if (!stream || bytes.view().empty()) fail(what, "left no ." + extension + " file");
  return std::move(bytes).str();
}

}  // namespace strake::structure::ccx
