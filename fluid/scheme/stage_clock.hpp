#pragma once

#include <chrono>
#include <map>
#include <string>

namespace strake::fluid {

/// Adds the wall seconds between its construction and its end to one stage.
class StageClock {
 public:
  StageClock(std::map<std::string, double>& seconds, const char* stage)
      : seconds_(seconds[stage]), start_(std::chrono::steady_clock::now()) {}
  ~StageClock() {
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace strake::fluid
