#pragma once

#include "coupler/participant/conversation.hpp"
#include "coupler/participant/serve.hpp"
#include "coupler/precice/config/precice_config.hpp"
#include "coupler/precice/exchanged_data.hpp"
#include "coupler/precice/solver_mesh.hpp"
#include "proto/error.hpp"

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace strake {

/// Wall-clock time of sections that a solver names. They may lie in one another.
class Sections {
 public:
  void start(std::string name);
  /// Ends the one that was started last. Error(solver_fault) if none is open.
  void stop();
  /// Seconds so far under the names "seconds.<section>", of sections that have ended.
  std::map<std::string, double> seconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<std::pair<std::string, Clock::time_point>> open_;
  std::map<std::string, double> seconds_;
};

/// Tests what would keep a participant from taking part: its name, its meshes, its number of processes.
/// Error(case_file) with the file, or Error(command_line).
const PreciceConfig::Participant& checked_participant(const PreciceConfig&, const std::string& name, int rank,
                                                      int size);

/// A run as a solver sees it that asks for its next window, instead of answering a question. Between two
/// calls the coupler waits for the answer to its last question: Setup before `initialize`, Advance before the
/// end of a window, Stop before `finish`.
///
/// Functions throw Error for what the solver may not do, and for what the coupler reports.
class SolverRun {
 public:
  /// Connects as the environment says: STRAKE_CONNECT, STRAKE_NAME, STRAKE_CASE_HASH, STRAKE_TOKEN,
  /// STRAKE_KEY.
  SolverRun(const std::string& participant, const std::string& config, int rank, int size);
  /// Reports a fault if the run is not finished.
  ~SolverRun();

  const PreciceConfig& config() const { return config_; }
  const PreciceConfig::Participant& participant() const { return *me_; }
  /// A mesh that the solver provides. Error if that is another one.
  SolverMesh& mesh(const std::string& name);
  const SolverMesh& mesh(const std::string& name) const { return const_cast<SolverRun*>(this)->mesh(name); }
  /// True if the mesh is the solver's own and its faces are used. The coupler projects onto those of a
  /// structure, and Strake's water needs them. Those of a fluid are used if a mapping of the configuration
  /// file projects.
  bool uses_faces(const std::string& mesh) const;
  ExchangedData& data() { return data_; }
  const ExchangedData& data() const { return data_; }
  Sections& sections() { return sections_; }

  /// Room for what is written, at as many points as the meshes have now.
  void fit_data();
  /// A time to read at, from now [s]: from 0 to what is left of the window.
  void check_time(double relative) const;
  void initialize();
  void advance(double dt);
  /// The end of the solver's part. Before the run's end it is a fault; `why` says what it did.
  void finish(const std::string& why);
  /// An error that the solver was told: the run ends with it if the solver leaves before the end.
  void note(const Error& error) { noted_ = error; }

  bool initialized() const { return initialized_; }
  bool finished() const { return finished_; }
  bool ongoing() const { return ongoing_; }
  bool window_complete() const { return complete_; }
  double left() const { return ongoing_ ? window_.dt - done_ : 0; }  // [s] of the window
  double now() const { return window_.t + done_; }                   // [s]

  /// What the solver has to do, and whether it has asked for it.
  struct Duty {
    bool required = false, asked = false;
    bool ask() {
      asked = true;
      return required;
    }
    bool missed() const { return required && !asked; }
  };
  Duty initial_data, write_checkpoint, read_checkpoint;

 private:
  std::vector<InterfaceMesh> coupled_meshes() const;
  void prepare(const Setup&, const std::vector<InterfaceMesh>&);
  Description description_of(const InterfaceMesh&);
  void check_step(double dt) const;
  void await_window();
  void begin_window(const wire::Advance&);
  void settle(wire::Before);
  void send_window(std::vector<Field> fields);
  Error reason_to_leave(const std::string& otherwise) const;
  void leave_with(const Error&);

  PreciceConfig config_;
  const PreciceConfig::Participant* me_;
  bool is_structure_ = false, implicit_ = true, takes_history_ = false, sends_history_ = false;
  std::vector<SolverMesh> meshes_;
  ExchangedData data_;
  Sections sections_;
  std::string place_;  // who this is, for errors
  std::unique_ptr<Conversation> conversation_;
  bool initialized_ = false, finished_ = false, ongoing_ = false, complete_ = false;
  Window window_;
  double done_ = 0;                   // [s] of the window
  long answered_ = 0;                 // windows, each iteration counted
  std::vector<Sample> history_;       // what was written inside the window
  std::optional<double> start_read_;  // [s] start of the first window of which nothing later was read
  std::optional<Error> noted_;
};

/// How to reach the coupler, from the environment of a program that Strake starts: STRAKE_CONNECT,
/// STRAKE_NAME, STRAKE_CASE_HASH, STRAKE_TOKEN (proto/WIRE.md). Error(command_line) if one is missing or
/// cannot be.
ServeOptions connection_of_environment();

}  // namespace strake
