#pragma once

#include <atomic>
#include <cstdint>
#include <sched.h>
#include <utility>

namespace strake::fluid {

/// The threads of one parallel region wait here for one another. A thread tests the counter for a short time,
/// because the loops between two waits last microseconds. Then it sleeps, so that a busy machine can use its
/// processor.
class Barrier {
 public:
  explicit Barrier(int threads) : threads_(threads) {}
  void wait() {
    const std::uint32_t round = round_.load(std::memory_order_relaxed);
    if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == threads_) {
      arrived_.store(0, std::memory_order_relaxed);
      round_.store(round + 1, std::memory_order_release);
      round_.notify_all();
      return;
    }
    for (int look = 0; look < looks; ++look) {
      if (round_.load(std::memory_order_acquire) != round) return;
#if defined(__x86_64__)
      __builtin_ia32_pause();
#endif
    }
    for (int turn = 0; turn < turns; ++turn) {
      sched_yield();
      if (round_.load(std::memory_order_acquire) != round) return;
    }
    while (round_.load(std::memory_order_acquire) == round) round_.wait(round, std::memory_order_acquire);
  }

 private:
  static constexpr int looks = 300;  // a few microseconds
  static constexpr int turns = 200;  // some hundred microseconds where the processor is free
  int threads_;
  alignas(64) std::atomic<int> arrived_{0};
  alignas(64) std::atomic<std::uint32_t> round_{0};
};

/// One thread's view of the parallel region it works in.
struct Team {
  int index = 0, count = 1;
  Barrier* barrier = nullptr;
  void wait() const {
    if (count > 1) barrier->wait();
  }
  bool first() const { return index == 0; }
  /// This thread's part [begin, end) of 0 … n − 1.
  std::pair<std::int64_t, std::int64_t> share(std::int64_t n) const {
    return {n * index / count, n * (index + 1) / count};
  }
};

}  // namespace strake::fluid
