#pragma once

#include <string>
#include <sys/types.h>
#include <vector>

namespace strake::watch {

/// A process of a run on this machine, as the system's tables have it.
struct Process {
  std::string name;  // "coupler" | "fluid" | "structure"
  pid_t pid = 0;
  char state = '?';         // of /proc: R computing, S waiting, D disk, T stopped, Z ended
  long long started = 0;    // [ticks since the machine's start]: with the number, who it is
  double cpu_seconds = 0;   // user and system time so far
  double memory_bytes = 0;  // resident
};
/// "computing", "waiting", "stopped by a signal" …
std::string words_for_state(char state);

/// The participants that were started with this endpoint (run.json's), and the coupler that started them.
/// Asks the system, never the run. Empty where nothing is found.
std::vector<Process> processes_of(const std::string& endpoint);
/// What they do now, without looking through all others of the machine; false when one of them is gone.
bool refresh(std::vector<Process>&);

}  // namespace strake::watch
