// Equilibrium under the case's own load, without time.

#include "proto/error.hpp"
#include "structure/fem/solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace strake::structure::fem {

template <int dim>
void FemSolver<dim>::solve_static() {
  require_constrained(mesh());
  constexpr double end_of_ramps = std::numeric_limits<double>::infinity();
  constexpr double smallest_part = 1.0 / 64;  // of the load
  const Eigen::VectorXd full = own_load(end_of_ramps);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(mesh().n_unknowns());
  LinearSolver factors = linear_solver();
  double done = 0, part = 1;
  while (done < 1) {
    const double share = std::min(1.0, done + part);
    const Eigen::VectorXd force = share * full;
    Equilibrium equilibrium;
    equilibrium.division = division();
    equilibrium.residual = [&](const Eigen::VectorXd& x) {
      const Eigen::VectorXd inside = internal_force(x, x, 0);
      Equilibrium::Residual r{.value = force - inside};
      clear_constrained(r.value);
      r.scale = division().norm(force);
      r.floor = round_off(x, 0);
      return r;
    };
    equilibrium.correction = [&](const Eigen::VectorXd& r) {
      return factors.solve(r, enough_of_a_correction);
    };
    equilibrium.refresh = [&](const Eigen::VectorXd& x) {
      return factors.factorise(assembly_.tangent(x), mesh().fixed);
    };
    const bool regular = equilibrium.refresh(u);
    const NewtonResult result = regular ? solve(equilibrium, u, parameters_.fem.tolerance) : NewtonResult{};
    if (regular && result.converged && assembly_.smallest_jacobian(result.x) > 0) {
      u = result.x;
      done = share;
      continue;
    }
    part /= 2;
    if (part < smallest_part)
      throw Error(
          ExitCode::solver_fault, "structure (fem), static",
          fmt::format("no equilibrium found beyond {:.0f} % of the load", 100 * done),
          "lower structure.load.value, or hold the body in more places: structure.plate.supports, the "
          "supports of a structure.box, or [[structure.support]]");
  }
  state_.displacement = u;
  state_.velocity.setZero();
  state_.acceleration.setZero();
  state_.time = 0;
  saved_ = state_;
}

template void FemSolver<2>::solve_static();
template void FemSolver<3>::solve_static();

}  // namespace strake::structure::fem
