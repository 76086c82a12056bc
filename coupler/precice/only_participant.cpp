#include "coupler/precice/only_participant.hpp"

#include "proto/error.hpp"

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>

namespace strake {
namespace {

std::unique_ptr<::precice::Participant> participant;
void (*take_error)(const char*) = nullptr;

}  // namespace

void tell_error(const char* error) {
  if (take_error) return take_error(error);
  std::fprintf(stderr, "%s\n", error);
  participant.reset();  // tells the coupler
  std::fflush(nullptr);
  std::_Exit(static_cast<int>(ExitCode::solver_fault));
}

void make_only_participant(const std::string& name, const std::string& config, int rank, int size) {
  for_c([&] {
    if (participant)
      throw std::runtime_error("precice: this process has a participant already; finalize it first");
    participant = std::make_unique<::precice::Participant>(name, config, rank, size);
  });
}

::precice::Participant& only_participant() {
  if (!participant) throw std::runtime_error("precice: this process has no participant; create it first");
  return *participant;
}

void drop_only_participant() {
  participant.reset();
}

std::size_t count(int size) {
  if (size < 0) throw std::runtime_error("precice: a negative number of vertices, edges or faces");
  return static_cast<std::size_t>(size);
}

}  // namespace strake

void strake_precice_on_error(void (*take)(const char* error)) {
  strake::take_error = take;
}

void strake_precice_drop() {
  strake::drop_only_participant();
}
