// One rank of a fluid, of which one fails on request: STRAKE_FAULT=RANK:KIND:CALL:WINDOW in the environment.
// RANK: its number, or "all". KIND: "memory", "bug", "error", "thread", an exception that nobody catches, or
// "mpi", a call that MPI refuses. CALL: "build", "start" or "after", when the others have ended
// their part of `start`.

#include "coupler/participant/start_ranks.hpp"
#include "fluid/program.hpp"
#include "fluid/ranks/boomer_amg.hpp"
#include "fluid/ranks/zoltan_partition.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <chrono>
#include <cstdlib>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

namespace {

using namespace strake;

struct Wish {
  std::string rank, kind, call, window;
};

Wish read_wish() {
  const char* text = std::getenv("STRAKE_FAULT");
  std::istringstream words(text ? text : "");
  Wish wish;
  for (std::string* word : {&wish.rank, &wish.kind, &wish.call, &wish.window})
    std::getline(words, *word, ':');
  return wish;
}

[[noreturn]] void fail(const std::string& kind) {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  fmt::print(stderr, "[toy] [info] fault at {:.6f}\n", std::chrono::duration<double>(now).count());
  if (kind == "memory") throw std::bad_alloc();
  if (kind == "mpi") MPI_Send(nullptr, -1, MPI_CHAR, 0, 0, MPI_COMM_WORLD);
  if (kind == "bug") throw std::logic_error("a vector is too short");
  if (kind == "thread") std::thread([] { throw std::runtime_error("a loop has failed"); }).join();
  throw Error(ExitCode::solver_fault, "fluid, step 7", "the flow has blown up", "lower fluid.scheme.cfl");
}

/// A participant that does what another one does, until it fails.
class Faulty final : public Participant {
 public:
  Faulty(std::unique_ptr<Participant> own, Wish wish) : own_(std::move(own)), wish_(std::move(wish)) {}
  const InterfaceMesh& mesh() const override { return own_->mesh(); }
  const Description& description() const override { return own_->description(); }
  void start(const Window& window, const Input& input) override {
    const bool now = std::to_string(++windows_) == wish_.window;
    if (now && wish_.call == "start") fail(wish_.kind);
    own_->start(window, input);
    if (now && wish_.call == "after") fail(wish_.kind);
  }
  Advanced finish() override { return own_->finish(); }
  void rewind() override { own_->rewind(); }
  void commit(bool write_output) override { own_->commit(write_output); }
  void checkpoint(const std::filesystem::path& folder) override { own_->checkpoint(folder); }
  void resume(const std::filesystem::path& folder) override { own_->resume(folder); }
  void flush() override { own_->flush(); }

 private:
  std::unique_ptr<Participant> own_;
  Wish wish_;
  int windows_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  fluid::FluidProgram program;
  return ranks_main(
      argc, argv, program.program(),
      [&](const Setup& setup, Communicator& ranks) -> std::unique_ptr<Participant> {
        Wish wish = read_wish();
        if (wish.rank != "all" && wish.rank != std::to_string(ranks.rank())) wish = {};
        if (wish.call == "build") fail(wish.kind);
        return std::make_unique<Faulty>(
            program.build(setup, {&ranks, fluid::zoltan_partition, [&] { return fluid::boomer_amg(ranks); }}),
            wish);
      });
}
