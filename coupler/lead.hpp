#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>

#include "coupler/case_scheme.hpp"
#include "coupler/run_loop.hpp"
#include "coupler/serve.hpp"

namespace strake {

/// coupling.placement = "fluid": the scheme and the loop of windows run in the fluid's process, which is the
/// structure's coupler. An exchange then costs two messages instead of four. The coupler asks for some
/// windows at a time and hears a report of each, unwaited: it keeps the processes, the files and the console.

/// The fluid's side of it. hash: CaseFile::hash().
std::unique_ptr<Leader> make_leader(CouplingCase, const std::array<std::uint8_t, 32>& hash);

/// What the leader adds to a checkpoint; the coupler takes it into coupler.h5.
inline constexpr const char* led_file = "lead.h5";

/// The coupler's side: windows that the leader runs.
class LedLoop final : public WindowLoop {
 public:
  struct Options {
    RunPlan plan;
    std::vector<Column> measured;  // Scheme::measured
    int checkpoint_windows = 0;    // the leader rests at each multiple
    std::function<void(const Exchange&)> on_exchange = {};
  };
  LedLoop(Roster&, RemoteParticipant& leader, Options);
  bool finished() const override { return finished_; }
  const LoopState& state() const override { return state_; }
  CommittedWindow next() override;
  bool at_rest() const override { return left_ == 0; }

 private:
  void ask();
  Roster& roster_;
  RemoteParticipant& leader_;
  Options options_;
  LoopState state_;
  bool finished_ = false;
  std::uint64_t asked_ = 0, left_ = 0;  // windows of the question under way
  std::chrono::steady_clock::time_point asked_at_;
  double seconds_ = 0;  // [s] of one window, lately
};

/// A participant of which the coupler only knows what it is: another process leads it.
class Follower final : public Participant {
 public:
  Follower(InterfaceMesh mesh, Description description)
      : mesh_(std::move(mesh)), description_(std::move(description)) {}
  const InterfaceMesh& mesh() const override { return mesh_; }
  const Description& description() const override { return description_; }
  void start(const Window&, const Input&) override;
  Advanced finish() override;
  void rewind() override;
  void commit(bool) override;
  void checkpoint(const std::filesystem::path&) override;
  void resume(const std::filesystem::path&) override;

 private:
  InterfaceMesh mesh_;
  Description description_;
};

}  // namespace strake
