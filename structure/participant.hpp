#pragma once

#include "proto/case/case_keys.hpp"
#include "proto/files/result_file.hpp"
#include "proto/participant.hpp"
#include "proto/probe.hpp"
#include "proto/ranks/communicator.hpp"
#include "structure/body/parameters.hpp"
#include "structure/solver/solver.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace strake::structure {

/// What a solver understood, and how its own steps go into the case's window.
std::vector<std::string> describe(const Solver&, const Parameters&, const CommonKeys&);

/// One line of the table that `strake check` prints; empty for a solver without properties.
std::string properties_line(const std::string& kind, const Properties&);

/// A structure solver as the scheme sees it: force in, displacement (and velocity) out; probes, energies,
/// frames.
class StructureParticipant final : public Participant {
 public:
  /// On several ranks each has one, and all call the same functions. The first one writes.
  StructureParticipant(std::unique_ptr<Solver>, const Parameters&, const CommonKeys&, const Setup&,
                       Communicator* ranks = nullptr);

  const InterfaceMesh& mesh() const override { return solver_->interface(); }
  const Description& description() const override { return description_; }
  void start(const Window&, const Input&) override;
  Advanced finish() override;
  void rewind() override;
  void commit(bool write_output) override;
  void checkpoint(const std::filesystem::path& folder) override;
  void resume(const std::filesystem::path& folder) override;

 private:
  /// What the participant itself remembers; the solver keeps its own.
  struct State {
    double time = 0;                          // [s]
    bool solved = false;                      // statics and modes are solved once
    std::vector<double> frequencies;          // [Hz]
    std::vector<ProbeRecord> probes;          // one per column of a probe
    double energy_scale = 0, energy_gap = 0;  // [J] largest energy so far; largest |ΔE − work| so far
  };
  void write_frame();
  void solve_once();
  void step(const Window&, const Input&);
  void follow(const Window&);
  void look_for_contact(const Window&, const Load&);
  Eigen::VectorXd measure(const ProbeKeys&) const;  // all components, those of a plane too
  std::vector<Field> motion() const;

  std::unique_ptr<Solver> solver_;
  Interpolation interpolation_ = Interpolation::linear;
  Analysis analysis_;
  Eigen::Vector3d support_velocity_;  // [m/s]
  struct ContactSearch {
    double fluid_density;    // [kg/m³]
    double pressure = 0;     // [Pa] ½ρV² of t = 0: from where on a probe's first peak counts
    bool from_rest = false;  // V is the speed of the body in the window
  };
  ContactSearch contact_;
  Eigen::VectorXd point_size_;  // n [m] length of the surface that a point's force comes from
  int dimension_;
  std::vector<ProbeKeys> probes_;  // those of the structure
  std::vector<Column> probe_columns_;
  Description description_;
  Eigen::VectorXd loaded_share_;  // n: share of each point that the water loads; empty: all of it
  struct Files {
    std::string name;  // "structure", or the body's
    std::optional<FrameSeries> frames;
    Communicator* ranks = nullptr;  // all make frames and checkpoints, the first one writes them
  };
  Files files_;
  bool has_first_frame_ = false;  // that at t = 0
  double first_energy_;           // [J] at t = 0
  double seconds_ = 0;            // wall, in the solver
  long steps_ = 0;                // taken, those of rewound windows too
  long committed_steps_ = 0;      // steps_ at the last commit
  State state_, committed_;
  std::optional<Advanced> failed_;  // instead of a result: a shorter window, please
};

}  // namespace strake::structure
