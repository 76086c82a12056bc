#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace strake {

class StopRequest;

/// 128 random bits as 32 hexadecimal digits.
std::string random_token();
/// The bytes of a hexadecimal text; empty if it is none.
std::string bytes_of(const std::string& hexadecimal);

/// Finds a program. `name` with a '/': a program of the user's, relative to `case_folder`. Else it is
/// searched beside the running executable, then on PATH. Of a program beside it the one for wider vectors is
/// taken where there is one (wide_program.hpp). Error(case_file) if there is none, with the searched places.
std::filesystem::path find_program(const std::string& name, const std::filesystem::path& case_folder = {});

struct Launch {
  std::filesystem::path program;
  std::vector<std::string> arguments;
  std::filesystem::path log;                       // standard output and error; empty: /dev/null
  int threads = 1;                                 // OMP_NUM_THREADS
  std::map<std::string, std::string> environment;  // added to (and replacing) that of this process
  bool keep_log = false;                           // append to the existing log
  std::filesystem::path folder = {};               // its current folder; empty: that of this process
  int input = -1;                                  // descriptor of its standard input; below 0: /dev/null
  bool own_command_line = false;  // `arguments` are all: a participant is told the rest by its environment
  /// The line of the case to which the program hands over: `fluid.launcher = "mpirun -n {ranks}"`. Empty: it
  /// stays one process.
  std::string launcher = {};
};

/// What every solver gets beside the environment of this process, so that it computes the same everywhere.
std::map<std::string, std::string> solver_environment(int threads);

/// LD_LIBRARY_PATH with the folder of Strake's libprecice.so.3 in front. A solver with a preCICE adapter
/// loads it. Empty where that library was not built.
std::string library_path();

/// A text as one word of a shell's command line.
std::string shell_word(const std::string&);

/// How a process ended.
struct Exit {
  int code = 0;    // exit code, if signal == 0
  int signal = 0;  // the signal that ended it
};
/// "exited with code 3", "was killed by signal 9 (Killed)".
std::string to_text(const Exit&);

/// A running program, in a process group of its own. The destructor ends and reaps it.
class Child {
 public:
  explicit Child(const Launch&);  // Error(participant_lost) if it cannot be started
  ~Child();
  Child(Child&&) noexcept;
  Child& operator=(Child&&) noexcept;

  pid_t pid() const { return pid_; }
  /// How it ended, or nothing while it runs. Never waits. A log that has become too long is shortened then.
  std::optional<Exit> exit();
  /// The same after at most `limit`.
  std::optional<Exit> wait(std::chrono::milliseconds limit);
  void signal(int number);                   // to its whole group
  void end(std::chrono::milliseconds term);  // SIGTERM, after `term` SIGKILL, reaped
  bool stopped() const;                      // by SIGSTOP or a terminal

 private:
  pid_t pid_ = -1;
  std::optional<Exit> exit_;
  std::filesystem::path log_;
};

/// Ends and reaps what the children left behind (orphans come to a sub-reaper). Child objects are left alone,
/// and so is every process that no program of ours started.
void end_orphans();

struct Captured {
  int exit_code = 0;  // 128 + signal if a signal ended it
  std::string out, err;
};
/// Runs a mode of a program (--keys, --echo, --check) to its end. Error(participant_lost) past the deadline
/// or if it cannot be started; Error(interrupted | terminated) if `stop` says so.
Captured capture(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                 std::chrono::milliseconds deadline = std::chrono::seconds(30),
                 const StopRequest* stop = nullptr);

/// Keeps freed memory in the process, up to 64 MB, so that the next window reuses it. Otherwise, in a process
/// that exchanges fields, the C library may return the memory of each field to the system and request it
/// again, page by page and cleared. This takes as much time as all the copies of a window. If
/// MALLOC_TRIM_THRESHOLD_ or GLIBC_TUNABLES is set, the user has decided.
void tune_malloc();

/// Finds the same program, compiled for wider vectors: lib/strake/x86-64-v3/NAME beside the folder of
/// `program`. Empty if there is none, if this processor lacks those instructions (AVX2, FMA), or if
/// STRAKE_VECTORS is "narrow". The last bits of results differ between the two.
std::filesystem::path wide_program(const std::filesystem::path& program);

}  // namespace strake
