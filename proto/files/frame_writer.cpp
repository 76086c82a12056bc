#include "proto/files/frame_writer.hpp"

#include "proto/files/blocked_signals.hpp"

#include <utility>

namespace strake {

FrameWriter::FrameWriter(std::filesystem::path run_folder, std::string name, int dimension)
    : series_(std::move(run_folder), std::move(name), dimension) {
  const BlockedSignals blocked;
  thread_ = std::thread([this] { work(); });
}

FrameWriter::~FrameWriter() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void FrameWriter::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stop_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const Frame frame = std::move(waiting_.front());
    waiting_.pop_front();
    busy_ = true;
    lock.unlock();
    changed_.notify_all();  // there is room again
    std::exception_ptr error;
    try {
      series_.write(frame);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    busy_ = false;
    if (error) {
      error_ = error;
      waiting_.clear();
      stop_ = true;
    }
    changed_.notify_all();
  }
}

void FrameWriter::rethrow() const {
  if (error_) std::rethrow_exception(error_);
}

void FrameWriter::check() {
  const std::lock_guard lock(mutex_);
  rethrow();
}

void FrameWriter::write(Frame frame) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return error_ || waiting_.size() < most_waiting; });
    rethrow();
    waiting_.push_back(std::move(frame));
  }
  changed_.notify_all();
}

void FrameWriter::flush() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return error_ || (waiting_.empty() && !busy_); });
  rethrow();
}

void FrameWriter::truncate(double time) {
  flush();
  series_.truncate(time);
}

}  // namespace strake
