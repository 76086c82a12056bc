#pragma once

#include "proto/ranks/communicator.hpp"

#include <chrono>
#include <map>
#include <string>

namespace strake::fluid {

/// Adds the wall seconds between its construction and its end to one stage. Messages to other ranks, and
/// waiting for them, count as stages of their own.
class StageClock {
 public:
  /// ranks: of a stage on several ranks; nullptr: one rank.
  StageClock(std::map<std::string, double>& seconds, const char* stage, const Communicator* ranks = nullptr)
      : all_(seconds), seconds_(seconds[stage]), ranks_(ranks), start_(std::chrono::steady_clock::now()) {
    if (ranks_) before_ = ranks_->account();
  }
  ~StageClock() {
    double own = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (ranks_) {
      const double halo = ranks_->account().seconds_apart - before_.seconds_apart,
                   waiting = ranks_->account().seconds_together - before_.seconds_together;
      all_["halo"] += halo;
      all_["waiting"] += waiting;
      own -= halo + waiting;
    }
    seconds_ += own;
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  std::map<std::string, double>& all_;
  double& seconds_;
  const Communicator* ranks_;
  Communicator::Account before_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace strake::fluid
