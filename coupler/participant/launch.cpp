#include "coupler/participant/launch.hpp"

#include "coupler/participant/long_log.hpp"
#include "coupler/participant/stop_request.hpp"
#include "proto/descriptor.hpp"
#include "proto/error.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <poll.h>
#include <set>
#include <signal.h>
#include <spawn.h>
#include <sstream>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

extern char** environ;

namespace strake {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// Processes that a Child object owns: `end_orphans` leaves them alone.
std::set<pid_t>& owned() {
  static std::set<pid_t> pids;
  return pids;
}

constexpr milliseconds end_beat{5};  // between two tests of a process that is about to end

/// The variable that every program started here has in its environment, and so has what it starts in turn.
constexpr const char* started_by = "STRAKE_STARTED_BY";

/// Its value: 128 random bits of this process. It separates our descendants from all other children. A shell
/// that became this process by `exec` leaves its background jobs to us, and we must not end them.
const std::string& own_mark() {
  static const std::string mark = std::string(started_by) + "=" + random_token();
  return mark;
}

/// Whether this process, or a program of its own, started that one. During `exec` its environment is empty.
bool is_descendant(pid_t pid) {
  for (int look = 0; look < 20; ++look, std::this_thread::sleep_for(milliseconds(1))) {
    std::ifstream file(fmt::format("/proc/{}/environ", pid));
    const std::string settings{std::istreambuf_iterator<char>(file), {}}, nul(1, '\0');
    if (!settings.empty()) return (nul + settings).find(nul + own_mark() + nul) != std::string::npos;
  }
  return false;
}

/// posix_spawn with its two attribute objects, which C wants destroyed.
class Spawn {
 public:
  Spawn() {
    posix_spawn_file_actions_init(&files_);
    posix_spawnattr_init(&attributes_);
    // A group of its own: Ctrl-C on the terminal reaches the coupler alone, which then ends the others in
    // order.
    posix_spawnattr_setflags(&attributes_,
                             POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setpgroup(&attributes_, 0);
    sigset_t set;
    sigemptyset(&set);
    posix_spawnattr_setsigmask(&attributes_, &set);
    for (int s : {SIGINT, SIGTERM, SIGPIPE, SIGHUP}) sigaddset(&set, s);
    posix_spawnattr_setsigdefault(&attributes_, &set);
    posix_spawn_file_actions_addopen(&files_, 0, "/dev/null", O_RDONLY, 0);
  }
  ~Spawn() {
    posix_spawn_file_actions_destroy(&files_);
    posix_spawnattr_destroy(&attributes_);
  }
  Spawn(const Spawn&) = delete;
  Spawn& operator=(const Spawn&) = delete;

  void open(int to, const std::filesystem::path& file, bool keep) {
    posix_spawn_file_actions_addopen(&files_, to, file.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND | (keep ? 0 : O_TRUNC), 0644);
  }
  void copy(int from, int to) { posix_spawn_file_actions_adddup2(&files_, from, to); }
  void change_folder(const std::filesystem::path& folder) {
    posix_spawn_file_actions_addchdir_np(&files_, folder.c_str());
  }

  pid_t run(const std::filesystem::path& program, const std::vector<std::string>& arguments,
            const std::map<std::string, std::string>& environment) const {
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<std::string> settings;
    for (char** entry = environ; *entry; ++entry) {
      const std::string setting = *entry, name = setting.substr(0, setting.find('='));
      if (name != started_by && !environment.contains(name)) settings.push_back(setting);
    }
    settings.push_back(own_mark());
    for (const auto& [name, value] : environment) settings.push_back(name + "=" + value);
    pid_t pid = -1;
    const int failure = posix_spawn(&pid, program.c_str(), &files_, &attributes_, pointers(words).data(),
                                    pointers(settings).data());
    if (failure == 0) return pid;
    const bool script = failure == ENOEXEC || (failure == ENOENT && access(program.c_str(), F_OK) == 0);
    throw Error(ExitCode::participant_lost, program.string(),
                fmt::format("cannot be started: {}", std::strerror(failure)),
                script ? "a script begins with its interpreter: #!/usr/bin/python3" : "");
  }

 private:
  static std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> p;
    for (std::string& t : texts) p.push_back(t.data());
    p.push_back(nullptr);
    return p;
  }
  posix_spawn_file_actions_t files_;
  posix_spawnattr_t attributes_;
};

std::filesystem::path folder_of_this_program() {
  std::error_code ignored;
  return std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
}

/// Returns PYTHONPATH with the packages of this version in front, in a build or an installation: `strake`
/// beside its messages coupling_pb2.py, and `precice`, which stands apart so that nothing else finds it by
/// chance.
std::string python_path() {
  const char* given = std::getenv("PYTHONPATH");
  const std::string path = given ? given : "";
  for (const std::string folder : {"python", "share/strake/python"}) {
    const auto packages = folder_of_this_program().parent_path() / folder;
    if (std::filesystem::exists(packages / "coupling_pb2.py"))
      return packages.string() + ":" + packages.string() + "_precice" + (path.empty() ? "" : ":" + path);
  }
  return path;
}

std::optional<Exit> reap(pid_t pid) {
  int status = 0;
  pid_t got = 0;
  do got = waitpid(pid, &status, WNOHANG);
  while (got < 0 && errno == EINTR);
  if (got == 0) return {};
  if (got < 0) return Exit{};  // reaped elsewhere: how it ended is not known
  if (WIFSIGNALED(status)) return Exit{0, WTERMSIG(status)};
  return Exit{WEXITSTATUS(status), 0};
}

/// Processes whose parent is this one, from /proc.
std::vector<pid_t> children() {
  std::vector<pid_t> found;
  std::error_code ignored;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", ignored)) {
    std::ifstream list(task.path() / "children");
    for (pid_t pid = 0; list >> pid;) found.push_back(pid);
  }
  return found;
}

}  // namespace

std::map<std::string, std::string> solver_environment(int threads) {
  std::map<std::string, std::string> environment{
      {"OMPI_MCA_ess_singleton_isolated",
       "1"},                           // else MPI_Init of a single process forks a daemon that outlives it
      {"OPENBLAS_NUM_THREADS", "1"},   // results must not depend on the machine
      {"OMP_WAIT_POLICY", "passive"},  // processes take turns: one that waits must not spin
      {"GOMP_SPINCOUNT", "2000"},  // but for the microseconds between two loops: sleeping there costs more
      {"OMP_NUM_THREADS", std::to_string(threads)},
  };
  if (const std::string path = python_path(); !path.empty()) environment["PYTHONPATH"] = path;
  return environment;
}

std::string library_path() {
  const auto folder = folder_of_this_program().parent_path() / "lib/strake/precice";
  if (!std::filesystem::exists(folder / "libprecice.so.3")) return {};
  const char* given = std::getenv("LD_LIBRARY_PATH");
  return folder.string() + (given && *given ? std::string(":") + given : "");
}

std::string shell_word(const std::string& text) {
  const std::string plain = "_-+=./:,@%";  // beside letters and digits
  const auto is_plain = [&](unsigned char c) {
    return std::isalnum(c) != 0 || plain.find(static_cast<char>(c)) != std::string::npos;
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

std::string random_token() {
  if (sodium_init() < 0) throw Error(ExitCode::our_bug, "libsodium", "cannot be initialised");
  std::array<unsigned char, 16> bits{};
  randombytes_buf(bits.data(), bits.size());
  return hexadecimal(bits);
}

std::string bytes_of(const std::string& hexadecimal) {
  std::string bytes(hexadecimal.size() / 2, '\0');
  std::size_t length = 0;
  if (sodium_hex2bin(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), hexadecimal.data(),
                     hexadecimal.size(), nullptr, &length, nullptr) != 0)
    length = 0;
  bytes.resize(length);
  return bytes;
}

std::filesystem::path find_program(const std::string& name, const std::filesystem::path& case_folder) {
  namespace fs = std::filesystem;
  std::error_code none;
  const auto runnable = [&](const fs::path& p) {
    return fs::is_regular_file(p, none) && access(p.c_str(), X_OK) == 0;
  };
  if (name.find('/') != std::string::npos) {
    const fs::path file = fs::absolute(case_folder / name).lexically_normal();
    if (runnable(file)) return file;
    throw Error(
        ExitCode::case_file, name,
        fmt::format("{} {}", file.string(), fs::exists(file, none) ? "cannot be executed" : "does not exist"),
        fs::exists(file, none) ? fmt::format("chmod +x {}", file.string())
                               : "a path is relative to the case file");
  }
  const fs::path beside = folder_of_this_program() / name;
  if (runnable(beside)) {
    const fs::path wide = wide_program(beside);
    return wide.empty() ? beside : wide;
  }
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (runnable(fs::path(folder) / name)) return fs::absolute(fs::path(folder) / name);
  throw Error(ExitCode::case_file, name,
              fmt::format("no such program beside {} or on PATH", beside.parent_path().string()),
              name == "strake-structure-fem" || name == "strake-structure-ccx"
                  ? "install libdeal.ii-dev and build again"
                  : "build it: ninja programs");
}

std::string to_text(const Exit& exit) {
  if (exit.signal != 0)
    return fmt::format("was killed by signal {} ({})", exit.signal, strsignal(exit.signal));
  return fmt::format("exited with code {}", exit.code);
}

Child::Child(const Launch& launch) : log_(launch.log) {
  prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0);  // what our children leave behind comes to us
  std::map<std::string, std::string> environment = solver_environment(launch.threads);
  for (const auto& [name, value] : launch.environment) environment[name] = value;
  Spawn spawn;
  spawn.open(1, launch.log.empty() ? "/dev/null" : launch.log, launch.keep_log);
  spawn.copy(1, 2);
  if (launch.input >= 0) spawn.copy(launch.input, 0);
  if (!launch.folder.empty()) spawn.change_folder(launch.folder);
  pid_ = spawn.run(launch.program, launch.arguments, environment);
  owned().insert(pid_);
}

Child::~Child() {
  if (pid_ > 0) end(milliseconds(500));
}

Child::Child(Child&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      exit_(std::exchange(other.exit_, std::nullopt)),
      log_(std::move(other.log_)) {}

Child& Child::operator=(Child&& other) noexcept {
  std::swap(pid_, other.pid_);
  std::swap(exit_, other.exit_);
  std::swap(log_, other.log_);
  return *this;
}

std::optional<Exit> Child::exit() {
  if (!exit_ && (exit_ = reap(pid_))) {
    owned().erase(pid_);
    take_out_middle(log_);
  }
  return exit_;
}

std::optional<Exit> Child::wait(milliseconds limit) {
  const auto end = steady_clock::now() + limit;
  while (!exit() && steady_clock::now() < end) std::this_thread::sleep_for(end_beat);
  return exit_;
}

void Child::signal(int number) {
  if (!exit()) kill(-pid_, number);
}

void Child::end(milliseconds term) {
  if (exit()) return;
  signal(SIGTERM);
  signal(SIGCONT);  // a suspended process reacts to nothing else
  if (wait(term)) return;
  signal(SIGKILL);
  wait(milliseconds(5000));  // a process inside the kernel (a dead network disk) may outlast even this
}

bool Child::stopped() const {
  std::ifstream stat(fmt::format("/proc/{}/stat", pid_));
  const std::string text{std::istreambuf_iterator<char>(stat), {}};
  const std::size_t name_end = text.rfind(')');  // pid (name) state …
  return name_end != std::string::npos && name_end + 2 < text.size() && text[name_end + 2] == 'T';
}

void end_orphans() {
  for (int round = 0; round < 3; ++round) {  // an orphan may leave orphans
    bool any = false;
    for (pid_t pid : children()) {
      if (owned().contains(pid) || reap(pid)) continue;
      if (!is_descendant(pid)) {
        reap(pid);  // what ends has no environment any more, and may have ended by now
        continue;
      }
      any = true;
      kill(pid, SIGKILL);
      const auto end = steady_clock::now() + milliseconds(500);
      while (!reap(pid) && steady_clock::now() < end) std::this_thread::sleep_for(end_beat);
    }
    if (!any) return;
  }
}

Captured capture(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                 milliseconds deadline, const StopRequest* stop) {
  std::array<std::array<int, 2>, 2> pipes{};
  if (pipe2(pipes[0].data(), O_CLOEXEC) != 0 || pipe2(pipes[1].data(), O_CLOEXEC) != 0)
    throw Error(ExitCode::participant_lost, program.string(),
                fmt::format("no pipe: {}", std::strerror(errno)));
  std::array<Descriptor, 2> ours{Descriptor(pipes[0][0]), Descriptor(pipes[1][0])};
  std::array<Descriptor, 2> theirs{Descriptor(pipes[0][1]), Descriptor(pipes[1][1])};
  Spawn spawn;
  spawn.copy(theirs[0].get(), 1);
  spawn.copy(theirs[1].get(), 2);
  std::map<std::string, std::string> environment = solver_environment(1);
  environment["STRAKE_COUPLER"] = std::to_string(getpid());  // it ends with this process
  const pid_t pid = spawn.run(program, arguments, environment);
  owned().insert(pid);
  for (Descriptor& d : theirs) d.close();

  const auto give_up = [&](ExitCode code, const std::string& problem) {
    kill(-pid, SIGKILL);
    while (!reap(pid)) std::this_thread::sleep_for(end_beat);
    owned().erase(pid);
    std::string words;
    for (const std::string& a : arguments) words += " " + a;
    throw Error(code, program.filename().string() + words, problem);
  };
  const auto end = steady_clock::now() + deadline;
  Captured result;
  std::array<std::string*, 2> texts{&result.out, &result.err};
  std::optional<Exit> exit;
  bool open = true;
  while (open || !exit) {
    std::array<pollfd, 2> waits{
        {{ours[0].get(), POLLIN, 0}, {ours[1].get(), POLLIN, 0}}};  // poll skips closed ones
    if (poll(waits.data(), waits.size(), open ? 50 : static_cast<int>(end_beat.count())) > 0)
      for (std::size_t i = 0; i < 2; ++i) {
        if (waits[i].revents == 0) continue;
        std::array<char, 65536> buffer;
        const ssize_t n = read(ours[i].get(), buffer.data(), buffer.size());
        if (n > 0)
          texts[i]->append(buffer.data(), static_cast<std::size_t>(n));
        else if (n == 0 || errno != EINTR)
          ours[i].close();
      }
    open = ours[0] || ours[1];
    if (!exit) exit = reap(pid);
    if (stop && stop->requested()) give_up(stop->code(), "interrupted");
    if (steady_clock::now() > end)
      give_up(ExitCode::participant_lost,
              fmt::format("has not ended within {} s", std::chrono::duration<double>(deadline).count()));
  }
  owned().erase(pid);
  result.exit_code = exit->signal != 0 ? 128 + exit->signal : exit->code;
  return result;
}

}  // namespace strake
