#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>

namespace strake {

/// What is kept of a long log [bytes]: of one that is longer than `most` the first and the last part.
struct LogBounds {
  std::size_t most = std::size_t{64} << 20, first = std::size_t{16} << 20, last = std::size_t{16} << 20;
};

/// Frees the disk space of the middle of a log that a program is writing. The program notices nothing and
/// loses no line, since nothing is moved: the middle reads as zeros. A line stands at its begin. Does nothing
/// on a file system that cannot do this, such as NFS 3. True if something was freed.
bool free_middle(const std::filesystem::path& log, const LogBounds& = {});

/// Takes the middle out of a long log whose program has ended: both parts stand one behind the other, with a
/// line between them that tells how much is left out.
void take_out_middle(const std::filesystem::path& log, const LogBounds& = {});

/// Looks after the length of one log, four times a second at most.
class LogLength {
 public:
  using Clock = std::chrono::steady_clock;
  /// True once: the first time that a part of the log was freed.
  bool look(const std::filesystem::path& log, Clock::time_point now);

 private:
  Clock::time_point next_;
  bool told_ = false;
};

}  // namespace strake
