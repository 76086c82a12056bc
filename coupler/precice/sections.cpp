#include "coupler/precice/sections.hpp"

#include "proto/error.hpp"

namespace strake {

void Sections::start(std::string name) {
  open_.emplace_back(std::move(name), Clock::now());
}

void Sections::stop() {
  if (open_.empty())
    throw Error(ExitCode::solver_fault, "sections", "none is open", "startProfilingSection() opens one");
  const auto& [name, since] = open_.back();
  seconds_["seconds." + name] += std::chrono::duration<double>(Clock::now() - since).count();
  open_.pop_back();
}

std::map<std::string, double> Sections::seconds() const {
  return seconds_;
}

}  // namespace strake
