#pragma once

#include "structure/particle/bonds.hpp"
#include "structure/particle/elastic_model.hpp"
#include "structure/particle/lattice.hpp"
#include "structure/solver.hpp"

#include <memory>

namespace strake::structure {

/// Elastic particles of one plate (plane strain), integrated by leapfrog in sub-steps below the elastic
/// limit.
class ParticleSolver final : public Solver {
 public:
  explicit ParticleSolver(const Parameters&);
  ParticleSolver(const ParticleSolver&) = delete;  // the model refers to the bonds
  ParticleSolver& operator=(const ParticleSolver&) = delete;

  const InterfaceMesh& interface() const override { return mesh_; }
  void advance(double t, double dt, const Load&) override;
  Points displacement() const override;
  /// Volume coupling: of the particles. Surface coupling: of the interface as its end places tell, so that
  /// windows longer than half a period of a mode feed it no energy (see solver.cpp).
  Points velocity() const override;
  bool sends_velocity() const override { return true; }
  double stable_dt() const override { return largest_step_; }  // its own sub-step: windows may be longer
  Energy energy() const override;
  int steps() const override { return state_.steps; }
  Eigen::Vector3d displacement_at(const Eigen::Vector3d& X) const override;
  Eigen::Vector3d velocity_at(const Eigen::Vector3d& X) const override;
  void save() override { saved_ = state_; }
  void restore() override { state_ = saved_; }
  void write(Archive&) const override;
  void read(const Archive&) override;
  Frame frame() const override;
  std::vector<std::string> lines() const override;
  void solve_static() override;
  std::vector<double> frequencies(int count) override;

  const Lattice& lattice() const { return lattice_; }
  /// The velocity of all particles, 2×n [m/s]: for tests that start in motion. Fixed particles keep that of
  /// the supports.
  void set_velocity(const Eigen::Matrix2Xd&);

 private:
  struct State {
    double time = 0;                 // [s]
    Eigen::Matrix2Xd displacement;   // 2×n [m]
    Eigen::Matrix2Xd velocity;       // 2×n [m/s]
    Eigen::Matrix2Xd elastic_force;  // 2×n [N/m] at `displacement`
    Points interface_velocity;       // 3×m [m/s] at the end of the last window, as the partner is told
    Points window_velocity;          // 3×m [m/s] mean over the last window
    double window = 0;               // [s] its length; 0: none yet
    double external_work = 0;        // [J/m] of loads, supports and damping
    int steps = 0;
  };
  void follow_interface(const Points& displacement_before, double dt);
  void sub_step(double dt, const Eigen::Matrix2Xd& external);
  Eigen::Matrix2Xd external_force(double time, const Eigen::Matrix2Xd& fluid) const;

  Parameters parameters_;
  Lattice lattice_;
  Bonds bonds_;
  double mass_;  // [kg/m] of one particle
  std::unique_ptr<ElasticModel> model_;
  InterfaceMesh mesh_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> to_interface_;  // u_interface = N u, f = Nᵀ f_interface
  Eigen::Matrix2Xd case_force_;                                // 2×n [N/m] of [structure.load] at full value
  double elastic_limit_, largest_step_;                        // [s]
  State state_, saved_;
};

}  // namespace strake::structure
