#pragma once

#include "proto/ranks/communicator.hpp"

#include <algorithm>
#include <array>
#include <condition_variable>
#include <exception>
#include <functional>
#include <limits>
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

   protected:
    std::vector<Bytes> gather_all(std::span<const std::byte> own) override {
      const std::vector<Bytes> to(static_cast<std::size_t>(size()), Bytes(own.begin(), own.end()));
      return all_.pass(rank_, to);
    }
    void pass_to_first(std::span<const std::byte> own,
                       const std::function<void(std::span<const std::byte>)>& visit) override {
      for (const Bytes& bytes : gather_all(own))
        if (rank_ == 0) visit(bytes);
    }
    Bytes gather_equal(std::span<const std::byte> own) override {
      Bytes joined;
      for (const Bytes& bytes : gather_all(own)) joined.insert(joined.end(), bytes.begin(), bytes.end());
      return joined;
    }
    std::vector<std::int64_t> pass_lengths(std::span<const std::int64_t> to) override {
      std::vector<Bytes> bytes(to.size());
      for (std::size_t r = 0; r < to.size(); ++r) append(bytes[r], to[r]);
      std::vector<std::int64_t> from;
      for (const Bytes& one : all_.pass(rank_, bytes)) from.push_back(values_of<std::int64_t>(one).front());
      return from;
    }
    void pass(std::span<const Bytes> to, std::span<Bytes> from) override {
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

/// Cuts the longest direction of the buckets into parts of equal work, again and again; a Partition.
inline std::vector<double> cut_in_halves(Communicator& ranks, std::span<const double> centres,
                                         std::span<const double> weights) {
  struct Object {
    std::array<double, 3> at;
    double weight;
  };
  Bytes own;
  for (std::size_t b = 0; b < weights.size(); ++b)
    append(own, Object{{centres[3 * b], centres[3 * b + 1], centres[3 * b + 2]}, weights[b]});
  std::vector<Object> all;
  for (const Bytes& bytes : ranks.gather(own))
    for (const Object& object : values_of<Object>(bytes)) all.push_back(object);
  std::vector<double> boxes(6 * static_cast<std::size_t>(ranks.size()));
  using Box = std::array<double, 6>;
  const std::function<void(std::vector<Object>, Box, int, int)> cut =
      [&](std::vector<Object> list, const Box& box, int first, int count) {
        if (count == 1) {
          std::ranges::copy(box, boxes.begin() + 6 * first);
          return;
        }
        std::size_t longest = 0;
        double extent = -1, work = 0, sum = 0;
        for (std::size_t d = 0; d < 3; ++d) {
          double low = 1e300, high = -1e300;
          for (const Object& object : list) {
            low = std::min(low, object.at[d]);
            high = std::max(high, object.at[d]);
          }
          if (high - low > extent) {
            extent = high - low;
            longest = d;
          }
        }
        std::ranges::sort(list, {}, [&](const Object& object) { return object.at[longest]; });
        for (const Object& object : list) work += object.weight;
        const int half = count / 2;
        std::size_t at = 0;
        while (at + 1 < list.size() && sum + 0.5 * list[at].weight < work * half / count)
          sum += list[at++].weight;
        // Halves of one bucket, from two ranks, stay together.
        while (at + 1 < list.size() && at > 0 && list[at].at[longest] == list[at - 1].at[longest]) ++at;
        const double bound = at > 0 ? 0.5 * (list[at - 1].at[longest] + list[at].at[longest]) : 0;
        Box lower = box, upper = box;
        lower[3 + longest] = upper[longest] = bound;
        cut({list.begin(), list.begin() + static_cast<std::ptrdiff_t>(at)}, lower, first, half);
        cut({list.begin() + static_cast<std::ptrdiff_t>(at), list.end()}, upper, first + half, count - half);
      };
  constexpr double far = std::numeric_limits<double>::max();
  cut(all, {-far, -far, -far, far, far, far}, 0, ranks.size());
  return boxes;
}

}  // namespace strake::fluid
