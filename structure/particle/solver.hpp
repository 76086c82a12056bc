#pragma once

#include "structure/particle/bonds.hpp"
#include "structure/particle/elastic_model.hpp"
#include "structure/particle/failure.hpp"
#include "structure/particle/lattice.hpp"
#include "structure/solver.hpp"

#include <map>
#include <memory>
#include <optional>

namespace strake::structure {

/// Elastic particles of a body of boxes (in the plane: plane strain), integrated by leapfrog in sub-steps
/// below the elastic limit.
template <int dim>
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
  void restore() override;
  void write(Archive&) const override;
  void read(const Archive&) override;
  Frame frame() const override;
  std::vector<std::string> lines() const override;
  std::vector<Column> columns() const override;
  std::map<std::string, double> monitor() const override;
  void solve_static() override;
  std::vector<double> frequencies(int count) override;
  Properties properties() override;

  const Lattice<dim>& lattice() const { return lattice_; }
  /// The velocity of all particles [m/s]: for tests that start in motion. Fixed particles keep that of
  /// the supports.
  void set_velocity(const Vectors<dim>&);
  /// Of all particles, those in the clamps included [kg m/s]; the angular one about the origin, their spins
  /// included [kg m²/s].
  Eigen::Vector3d momentum() const;
  Eigen::Vector3d angular_momentum() const;

 private:
  struct State {
    double time = 0;                     // [s]
    Vectors<dim> displacement;           // [m]
    Vectors<dim> velocity;               // [m/s]
    Vectors<dim> elastic_force;          // [N] ([N/m]) at `displacement`
    Eigen::VectorXd turn, spin, torque;  // n [rad], [rad/s], [N m/m]; empty unless particles spin
    Points interface_velocity;           // 3×m [m/s] at the end of the last window, as the partner is told
    Points window_velocity;              // 3×m [m/s] mean over the last window
    double window = 0;                   // [s] its length; 0: none yet
    typename Failure<dim>::State failure;
    double external_work = 0;  // [J] ([J/m]) of loads, supports and damping
    int steps = 0;
  };
  void follow_interface(const Points& displacement_before, double dt);
  void sub_step(double dt, const Vectors<dim>& external);
  double turn_half(double dt, bool first);
  void find_elastic_force();
  void break_bonds();
  double strain_energy() const;
  Vectors<dim> external_force(double time, const Vectors<dim>& fluid) const;

  Parameters parameters_;
  Lattice<dim> lattice_;
  Bonds<dim> bonds_;
  Eigen::VectorXd mass_;     // [kg] ([kg/m]) of each particle
  Eigen::VectorXd inertia_;  // [kg m] of each about z; empty unless particles spin
  std::unique_ptr<ElasticModel<dim>> model_;
  std::optional<Failure<dim>> failure_;  // its damage is in the state, and from there in the bonds
  InterfaceMesh mesh_;
  SparseRows to_interface_;              // u_interface = N u, f = Nᵀ f_interface
  Vectors<dim> case_force_;              // [N] ([N/m]) of [structure.load] at full value
  double elastic_limit_, largest_step_;  // [s]
  State state_, saved_;
};

/// The solver of a body's dimension.
std::unique_ptr<Solver> make_particle_solver(const Parameters&);

}  // namespace strake::structure
