#include "proto/files/frame_writer.hpp"

#include <pthread.h>
#include <signal.h>
#include <utility>

namespace strake {
namespace {

/// Signals are for the thread that computes: a new thread inherits what is blocked while it is made.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

 private:
  sigset_t before_;
};

}  // namespace

FrameWriter::FrameWriter(std::filesystem::path run_folder, std::string name, int dimension)
    : series_(std::move(run_folder), std::move(name), dimension) {
  const SignalsBlocked blocked;
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
