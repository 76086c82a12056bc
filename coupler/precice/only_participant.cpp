#include "coupler/precice/only_participant.hpp"

#include "proto/error.hpp"

#include <cstdio>
#include <cstdlib>
#include <memory>

namespace strake {
namespace {

std::unique_ptr<::precice::Participant> participant;

}  // namespace

void end_process(const char* error) {
  std::fprintf(stderr, "%s\n", error);
  participant.reset();  // tells the coupler
  std::fflush(nullptr);
  std::_Exit(static_cast<int>(ExitCode::solver_fault));
}

void make_only_participant(const std::string& name, const std::string& config, int rank, int size) {
  if (participant) end_process("precice: this process has a participant already; finalize it first");
  for_c([&] { participant = std::make_unique<::precice::Participant>(name, config, rank, size); });
}

::precice::Participant& only_participant() {
  if (!participant) end_process("precice: this process has no participant; create it first");
  return *participant;
}

void drop_only_participant() {
  participant.reset();
}

std::size_t count(int size) {
  if (size < 0) end_process("precice: a negative number of vertices, edges or faces");
  return static_cast<std::size_t>(size);
}

}  // namespace strake
