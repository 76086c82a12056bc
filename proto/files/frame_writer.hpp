#pragma once

#include "proto/files/result_file.hpp"

#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

namespace strake {

/// Writes a frame series in a thread of its own, so that the solver computes on meanwhile. Frames keep their
/// order.
class FrameWriter {
 public:
  FrameWriter(std::filesystem::path run_folder, std::string name, int dimension);
  ~FrameWriter();  // what waits is still written; an error of it is lost: `flush` first
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  /// Queues a frame; waits while `most_waiting` others are queued. Throws the error of an earlier frame, if
  /// any.
  void write(Frame);
  /// Throws Error(cannot_write) if a frame handed over earlier could not be written; none is tried after it.
  void check();
  /// Returns when every frame is on disk; throws as `check` does.
  void flush();
  /// Drops frames later than `time` (resume).
  void truncate(double time);

 private:
  static constexpr std::size_t most_waiting = 2;  // frames; more would only cost memory
  void work();
  void rethrow() const;  // the caller has locked the mutex

  FrameSeries series_;  // of the thread, while it is busy
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Frame> waiting_;
  bool busy_ = false, stop_ = false;
  std::exception_ptr error_;
  std::thread thread_;
};

}  // namespace strake
