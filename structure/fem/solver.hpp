#pragma once

#include "structure/body/parameters.hpp"
#include "structure/fem/element/assembly.hpp"
#include "structure/fem/element/damage.hpp"
#include "structure/fem/linear/linear_solver.hpp"
#include "structure/fem/mesh/mesh.hpp"
#include "structure/fem/mesh/point_interpolation.hpp"
#include "structure/fem/mesh/recovery.hpp"
#include "structure/fem/newmark.hpp"
#include "structure/fem/newton.hpp"
#include "structure/fem/support_motion.hpp"
#include "structure/solver/solver.hpp"

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace strake::structure::fem {

/// Dynamic elasticity of a body on driven supports by finite elements:
///   M ü + C u̇ + f(u) = F,  C = mass·M + stiffness·K(0)  (Rayleigh)
/// The unknown is the displacement u relative to the supports, so that rounding acts on the deflection alone;
/// that of the supports, D, is added to what the outside sees. Where their frame is accelerated, by a table
/// or as a lumped mass that is free, the body feels −M 1 A in it, see SupportMotion. The window's load is the
/// mean force over the window; one window is one step.
template <int dim>
class FemSolver final : public Solver {
 public:
  /// On several ranks all call the same functions.
  explicit FemSolver(const Parameters&, Communicator* ranks = nullptr);
  const InterfaceMesh& interface() const override { return interface_; }
  void advance(double t, double dt, const Load&) override;
  Points displacement() const override;
  Points velocity() const override;
  bool sends_velocity() const override { return !scheme_.mid_point || support_motion_.supports().by_table(); }
  /// As an observer at rest sees it. `external` is the work of loads and supports, less what the damping
  /// took.
  Energy energy() const override;
  int steps() const override { return state_.steps; }
  Eigen::Vector3d displacement_at(const Eigen::Vector3d& X) const override;
  Eigen::Vector3d velocity_at(const Eigen::Vector3d& X) const override;
  std::optional<Eigen::Vector3d> support_displacement(const Eigen::Vector3d& X) const override;
  std::vector<Column> columns() const override;
  std::map<std::string, double> monitor() const override;
  /// Linear momentum of the body and a free frame [kg m/s].
  Eigen::Vector3d momentum() const;
  /// Mean over the cells of one part that meet in the nodes around it.
  bool has_stress() const override { return true; }
  Stress stress_at(const Eigen::Vector3d& X) const override;
  void save() override { saved_ = state_; }
  void restore() override;
  void write(Archive&) const override;
  void read(const Archive&) override;
  Frame frame() const override;
  std::vector<std::string> lines() const override;
  void solve_static() override;
  std::vector<double> frequencies(int count) override { return frequencies(count, 1e-12); }
  Properties properties() override;

  const RankDivision& division() const { return mesh().division; }
  /// For tests of the method: the mesh, and the displacement of its nodes relative to the supports.
  const Mesh<dim>& mesh() const { return discretisation_.mesh(); }
  const Eigen::VectorXd& unknowns() const { return state_.displacement; }
  /// Sets displacement and velocity [m], [m/s] relative to the supports, except in constrained unknowns.
  void set_unknowns(Eigen::VectorXd displacement, Eigen::VectorXd velocity);
  int newton_iterations() const { return newton_iterations_; }  // of the last step
  int factorisations() const { return factors_.made; }          // so far

 private:
  /// All that changes in time. The tangent's place and step are in it, so that a step taken again after
  /// `restore`, or after a resume, uses the same factors and gives the same bits.
  struct State {
    double time = 0;                                       // [s]
    Eigen::VectorXd displacement, velocity, acceleration;  // relative to the supports
    FrameState frame;                                      // of the supports
    Eigen::Vector3d reaction = Eigen::Vector3d::Zero();    // [N] of the supports on the body, last step
    Eigen::VectorXd tangent_at;                            // displacement where the tangent was taken
    double tangent_dt = 0;                                 // [s] for which it was made
    double external = 0;                                   // [J]
    typename Damage<dim>::State damage = {};
    int steps = 0;
  };

  /// What is given of a step: the state before it, the told motion of the supports after it, and the load.
  struct GivenStep {
    const State& old;
    FrameState told;
    Eigen::VectorXd force;  // [N]
    double dt;              // [s]
  };

  void start();
  Eigen::Vector3d gravity_at(double time) const;  // [m/s²]
  Eigen::VectorXd own_load(double time) const;    // gravity and [structure.load], [N]
  Eigen::VectorXd internal_force(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1, double alpha) const;
  Matrix effective(Matrix tangent, double dt) const;
  void use_tangent(const State&);
  Eigen::VectorXd load_of_window(double t, double dt, const Load&) const;
  Eigen::VectorXd damping_force(const GivenStep&, const Eigen::VectorXd& u1) const;
  NewtonResult solve_step(const GivenStep&, Eigen::VectorXd start);
  Eigen::Matrix<double, dim, 1> frame_acceleration(const GivenStep&, const Eigen::VectorXd& inertia) const;
  void account(const GivenStep&, State& next) const;
  void step(double t, double dt, const Load&, int halved);
  NewtonResult solve_softening(const GivenStep&, typename Damage<dim>::State& damage);
  void clear_constrained(Eigen::VectorXd& unknowns) const;
  void turn_held(const FrameState&, Eigen::VectorXd& displacement) const;
  double work_of_turn(const GivenStep&, const State& next, const Eigen::VectorXd& inertia) const;
  double round_off(const Eigen::VectorXd& u, double kappa) const;  // [N] of a step's forces at u
  LinearSolver linear_solver() const;
  std::string strain_line() const;
  std::string linear_systems_line() const;
  std::vector<double> frequencies(int count, double tolerance) const;

  // Relative tolerance of an iterative solve for a correction. The rest is left to the next correction, since
  // Newton's method computes the residual anew.
  static constexpr double enough_of_a_correction = 1e-6;
  // Of the square of the first frequency, for the line that shows five figures of it.
  static constexpr double enough_for_a_line = 1e-8;

  Parameters parameters_;
  TimeScheme scheme_;
  Solid solid_;
  bool linear_;  // all parts are
  Discretisation<dim> discretisation_;
  Assembly<dim> assembly_;
  std::optional<Damage<dim>> failure_;  // its damage is in the state, and from there in the assembly
  Recovery<dim> recovery_;
  struct Matrices {
    Matrix mass, stiffness = {};     // stiffness at u = 0
    Eigen::VectorXd node_mass = {};  // [kg] row sums
    double largest_stiffness = 0, largest_node_mass = 0;
  } matrices_;
  SupportMotion<dim> support_motion_;
  InterfaceMesh interface_;
  PointInterpolation<dim> interpolation_;
  Eigen::VectorXd load_shape_;                   // [N] of [structure.load] at full value
  struct Summary {                               // for the lines of a run
    double first_frequency = 0;                  // [Hz]
    int fewest_unknowns = 0, most_unknowns = 0;  // of a rank
  } summary_;
  State state_, saved_;

  // Not state: factors, kept by what they were made of.
  struct Factors {
    LinearMethod method = LinearMethod::direct;  // automatic: conjugate gradients with factors behind them
    std::shared_ptr<GivenUp> given_up = std::make_shared<GivenUp>();
    LinearSolver kept, fresh;
    Eigen::VectorXd at;  // displacement
    double dt = 0;       // [s]
    int made = 0;        // so far
  } factors_;
  // Places that were asked for.
  struct Probe {
    PointInterpolation<dim> at;
    std::vector<typename Recovery<dim>::Share> stress;
  };
  mutable std::map<std::array<double, 3>, Probe> probes_;
  const Probe& probe(const Eigen::Vector3d& X) const;
  int newton_iterations_ = 0;
};

}  // namespace strake::structure::fem
