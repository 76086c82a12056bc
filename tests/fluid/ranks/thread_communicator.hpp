#pragma once

#include "proto/ranks/communicator.hpp"

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

namespace strake::fluid {

/// Ranks that are threads of one process. A rank that throws ends the waiting of the others.
class ThreadRanks {
 public:
  explicit ThreadRanks(int size)
      : messages_(static_cast<std::size_t>(size), std::vector<Bytes>(static_cast<std::size_t>(size))) {}

  /// Calls body(communicator) on each rank, and throws what the first of them has thrown.
  void run(const std::function<void(Communicator&)>& body) {
    std::vector<std::jthread> threads;
    for (int rank = 0; rank < size(); ++rank)
      threads.emplace_back([this, rank, &body] {
        Rank own(*this, rank);
        try {
          body(own);
        } catch (const Ended&) {  // another rank has thrown
        } catch (...) {
          end(std::current_exception());
        }
      });
    threads.clear();
    if (error_) std::rethrow_exception(error_);
  }

 private:
  struct Ended : std::runtime_error {
    Ended() : std::runtime_error("another rank has ended") {}
  };

  class Rank final : public Communicator {
   public:
    Rank(ThreadRanks& all, int rank) : all_(all), rank_(rank) {}
    int rank() const override { return rank_; }
    int size() const override { return all_.size(); }
    std::vector<Bytes> gather(std::span<const std::byte> own) override {
      const std::vector<Bytes> to(static_cast<std::size_t>(size()), Bytes(own.begin(), own.end()));
      return all_.pass(rank_, to);
    }
    void exchange(std::span<const Bytes> to, std::span<Bytes> from) override {
      const std::vector<Bytes> arrived = all_.pass(rank_, to);
      for (std::size_t r = 0; r < arrived.size(); ++r) {
        if (static_cast<int>(r) == rank_) continue;
        if (arrived[r].size() != from[r].size())
          throw std::logic_error("a message has another length than expected");
        from[r] = arrived[r];
      }
    }

   private:
    ThreadRanks& all_;
    int rank_;
  };

  int size() const { return static_cast<int>(messages_.size()); }

  std::vector<Bytes> pass(int rank, std::span<const Bytes> to) {
    for (std::size_t r = 0; r < messages_.size(); ++r) messages_[r][static_cast<std::size_t>(rank)] = to[r];
    wait();
    std::vector<Bytes> from = messages_[static_cast<std::size_t>(rank)];
    wait();
    return from;
  }

  void wait() {
    std::unique_lock lock(mutex_);
    if (error_) throw Ended();
    const std::size_t turn = turn_;
    if (++waiting_ == messages_.size()) {
      waiting_ = 0;
      ++turn_;
      all_there_.notify_all();
      return;
    }
    all_there_.wait(lock, [&] { return turn_ != turn || error_; });
    if (turn_ == turn) throw Ended();
  }

  void end(std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = std::move(error);
    all_there_.notify_all();
  }

  std::vector<std::vector<Bytes>> messages_;  // by receiver and sender
  std::mutex mutex_;
  std::condition_variable all_there_;
  std::size_t waiting_ = 0, turn_ = 0;
  std::exception_ptr error_;
};

/// Cuts the longest direction of the buckets into parts of equal work, again and again.
inline std::vector<int> cut_in_halves(std::span<const double> centres, std::span<const double> weights,
                                      int parts) {
  std::vector<int> owner(weights.size(), 0);
  const std::function<void(std::vector<std::size_t>, int, int)> cut = [&](std::vector<std::size_t> list,
                                                                          int first, int count) {
    if (count == 1) {
      for (const std::size_t b : list) owner[b] = first;
      return;
    }
    std::size_t longest = 0;
    double extent = -1;
    for (std::size_t d = 0; d < 3; ++d) {
      double low = 1e300, high = -1e300;
      for (const std::size_t b : list) {
        low = std::min(low, centres[3 * b + d]);
        high = std::max(high, centres[3 * b + d]);
      }
      if (high - low > extent) {
        extent = high - low;
        longest = d;
      }
    }
    std::ranges::stable_sort(list, {}, [&](std::size_t b) { return centres[3 * b + longest]; });
    double work = 0, sum = 0;
    for (const std::size_t b : list) work += weights[b];
    const int half = count / 2;
    std::size_t at = 0;
    while (at < list.size() && sum + 0.5 * weights[list[at]] < work * half / count)
      sum += weights[list[at++]];
    cut({list.begin(), list.begin() + static_cast<std::ptrdiff_t>(at)}, first, half);
    cut({list.begin() + static_cast<std::ptrdiff_t>(at), list.end()}, first + half, count - half);
  };
  std::vector<std::size_t> every(weights.size());
  for (std::size_t b = 0; b < every.size(); ++b) every[b] = b;
  cut(every, 0, parts);
  return owner;
}

}  // namespace strake::fluid
