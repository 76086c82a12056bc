#pragma once

#include "structure/particle/bonds.hpp"
#include "structure/particle/constraints.hpp"
#include "structure/particle/elastic_model.hpp"
#include "structure/particle/failure.hpp"
#include "structure/particle/lattice.hpp"
#include "structure/rigid/support_frame.hpp"
#include "structure/solver/solver.hpp"

#include <map>
#include <memory>
#include <optional>

namespace strake::structure {

/// Elastic particles of a body, integrated by leapfrog in sub-steps below the elastic limit. Fixed particles
/// (those of clamps and of held parts) move with the frame of the supports. Along free axes the frame is one
/// more mass, its own and the lumped one, which leapfrog moves like any other.
template <int dim>
class ParticleSolver final : public Solver {
 public:
  explicit ParticleSolver(const Parameters&);
  ParticleSolver(const ParticleSolver&) = delete;  // the model refers to the bonds
  ParticleSolver& operator=(const ParticleSolver&) = delete;

  const InterfaceMesh& interface() const override { return mesh_; }
  void advance(double t, double dt, const Load&) override;
  Points displacement() const override;
  /// Volume coupling: velocity of the particles. Surface coupling: velocity of the interface from its places
  /// at window ends, so that windows longer than half a period of a mode add no energy to it (see
  /// solver.cpp).
  Points velocity() const override;
  double stable_dt() const override { return largest_step_; }  // its own sub-step: windows may be longer
  Energy energy() const override;
  int steps() const override { return state_.steps; }
  Eigen::Vector3d displacement_at(const Eigen::Vector3d& X) const override;
  Eigen::Vector3d velocity_at(const Eigen::Vector3d& X) const override;
  bool has_stress() const override { return true; }
  Stress stress_at(const Eigen::Vector3d& X) const override;
  void save() override { saved_ = state_; }
  void restore() override;
  void write(Archive&) const override;
  void read(const Archive&) override;
  Frame frame() const override;
  std::vector<std::string> lines() const override;
  std::optional<Eigen::Vector3d> support_displacement(const Eigen::Vector3d& X) const override;
  std::vector<Column> columns() const override;
  std::map<std::string, double> monitor() const override;
  void solve_static() override;
  std::vector<double> frequencies(int count) override;
  Properties properties() override;

  const Lattice<dim>& lattice() const { return lattice_; }
  /// Sets the velocity of all particles [m/s], for tests that start in motion. Fixed particles keep that of
  /// the supports.
  void set_velocity(const Vectors<dim>&);
  /// Momentum of the body's particles and a free frame [kg m/s]. The angular momentum [kg m²/s] is about the
  /// origin and includes the spins, not the frame.
  Eigen::Vector3d momentum() const;
  Eigen::Vector3d angular_momentum() const;

 private:
  using Vector = Eigen::Matrix<double, dim, 1>;
  struct State {
    double time = 0;                                     // [s]
    FrameState frame;                                    // of the supports
    Eigen::Vector3d reaction = Eigen::Vector3d::Zero();  // [N] of the supports on the body, last sub-step
    Vectors<dim> displacement;                           // [m]
    Vectors<dim> velocity;                               // [m/s]
    Vectors<dim> elastic_force;                          // [N] ([N/m]) at `displacement`
    Eigen::VectorXd turn, spin, torque;  // n [rad], [rad/s], [N m/m]; empty unless particles spin
    Points interface_velocity;           // 3×m [m/s] at the end of the last window, as sent to the partner
    Points window_velocity;              // 3×m [m/s] mean over the last window
    double window = 0;                   // [s] its length; 0: none yet
    typename Failure<dim>::State failure;
    double external_work = 0;  // [J] ([J/m]) of loads, supports and damping
    int steps = 0;
  };
  void take_window(double t, double dt, int n_steps, const Load&);
  bool is_finite() const;
  bool is_sound(const Energy& before) const;
  Eigen::MatrixXd cauchy_stress() const;  // 6×n [Pa], as Stress orders it
  void follow_interface(const Points& displacement_before, double dt);
  void sub_step(double dt, const Vectors<dim>& external, const Vector& gravity);
  Vector kick(double dt, const Vectors<dim>& external, const Vector& frame_velocity, bool first);
  Vector held_place(const FrameState&, Eigen::Index particle) const;
  Vector constrained_velocity(const FrameState&, Eigen::Index particle) const;
  Vector pull_on_frame(const Vectors<dim>& external, const Vector& gravity) const;
  double turn_half(double dt, bool first);
  void find_elastic_force();
  void break_bonds(double time);
  double strain_energy() const;
  Vector gravity_at(double time) const;
  Vectors<dim> external_force(double time, const Vectors<dim>& fluid) const;
  Vector frame_mass() const;
  void start();

  Parameters parameters_;
  SupportFrame frame_;
  Lattice<dim> lattice_;
  Bonds<dim> bonds_;
  Eigen::VectorXd mass_;     // [kg] ([kg/m]) of each particle
  Eigen::VectorXd inertia_;  // [kg m] of each about z; empty unless particles spin
  double fixed_mass_;        // [kg] of the body's particles that are fixed
  Constraints<dim> constraints_;
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
