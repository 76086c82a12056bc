#include "fluid/pressure_solver/poisson_solver.hpp"

#include "fluid/particles/kernel.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::fluid {
namespace {

/// Number of iterations with the diagonal that cost as much as the grids, set-up included. Measured with 1e4
/// to 1e6 unknowns.
constexpr double grids_in_jacobi_iterations = 30;
/// Number of rows from which the compressible share is computed. It is the same in all rows inside the water.
constexpr std::int64_t sampled_rows = 512;
/// Number of rows below which threads cost more time than they save.
constexpr std::int64_t rows_for_threads = 4000;

double compressible_share(const PressureSystem& system) {
  const std::int64_t n = system.size(), step = std::max<std::int64_t>(1, n / sampled_rows);
  double smallest = 1;
  for (std::int64_t k = 0; k < n; k += step) {
    const auto row = static_cast<std::size_t>(k);
    double sum = system.diagonal[k];
    for (std::int64_t e = system.start[row]; e < system.stop[row]; ++e)
      sum += system.value[static_cast<std::size_t>(e)];
    smallest = std::min(smallest, sum / system.diagonal[k]);
  }
  constexpr double round_off = 1e-12;
  return smallest > round_off ? smallest : 0;
}

bool is_open(const Scheme& scheme) {
  return scheme.preconditioner == Preconditioner::automatic;
}

PressureChoice choose(double share, const Scheme& scheme) {
  PressureChoice choice{scheme.preconditioner, share, 0};
  if (!is_open(scheme)) return choice;
  choice.jacobi_iterations = std::numeric_limits<double>::infinity();
  if (share > 0) {
    const double root = std::sqrt((2 - share) / share);
    choice.jacobi_iterations =
        root > 1 ? std::log(2 / scheme.pressure_tolerance) / std::log((root + 1) / (root - 1)) : 1;
  }
  choice.preconditioner = choice.jacobi_iterations <= grids_in_jacobi_iterations ? Preconditioner::jacobi
                                                                                 : Preconditioner::multilevel;
  return choice;
}

}  // namespace

PressureChoice choose_pressure_solver(const PressureSystem& system, const Scheme& scheme) {
  return choose(is_open(scheme) ? compressible_share(system) : 0, scheme);
}

PressureChoice choose_pressure_solver(const PressureSystem& system, const Scheme& scheme,
                                      Communicator& ranks) {
  return choose(is_open(scheme) ? -ranks.max(-compressible_share(system)) : 0, scheme);
}

template <int dim>
PressureChoice expected_pressure_solver(const Parameters& p, double dt) {
  const LatticeConstants lattice = lattice_constants<dim>(p.scheme.radius_laplacian, p.spacing);
  const double reach = p.sound_speed * dt;
  const bool holds = std::isfinite(reach) && std::isinf(p.sound_depth);  // every row
  return choose(holds ? 1 / (1 + 2 * dim * reach * reach / lattice.lambda0) : 0, p.scheme);
}

std::string PressureChoice::text() const {
  const char* name = preconditioner == Preconditioner::jacobi ? "jacobi" : "multilevel";
  if (jacobi_iterations == 0) return fmt::format("cg with {}, as the case asks", name);
  if (compressible_share == 0) return fmt::format("cg with {}: incompressible", name);
  return fmt::format(
      "cg with {}: compressibility holds {:.2g} of the diagonal, jacobi alone takes up to {:.0f} iterations",
      name, compressible_share, jacobi_iterations);
}

template <int dim>
const PressureSolution& PoissonSolver<dim>::solve(const PressureSystem& system, const Vectors<dim>& position,
                                                  const Eigen::VectorXd& guess, const Scheme& scheme) {
  const std::int64_t n = system.size();
  solution_.pressure = guess;
  solution_.iterations = 0;
  solution_.residual = 0;
  if (n == 0) return solution_;
  choice_ = choose_pressure_solver(system, scheme);
  const int threads = n >= rows_for_threads ? omp_get_max_threads() : 1;
  const bool grids = choice_.preconditioner == Preconditioner::multilevel;
  if (grids) multilevel_.build(system, position, radius_, scheme.radius_laplacian, threads);
  cg_.solve<dim>(system, grids ? &multilevel_ : nullptr, scheme.pressure_tolerance,
                 scheme.pressure_max_iterations, threads, solution_);
  return solution_;
}

double pressure_residual(const PressureSystem& system, const Eigen::VectorXd& pressure) {
  double r2 = 0, b2 = 0;
  for (std::int64_t k = 0; k < system.size(); ++k) {
    const double r = system.right[k] - row_times(system, pressure.data(), k);
    r2 += r * r;
    b2 += system.right[k] * system.right[k];
  }
  return b2 == 0 ? std::sqrt(r2) : std::sqrt(r2 / b2);
}

template PressureChoice expected_pressure_solver<2>(const Parameters&, double);
template PressureChoice expected_pressure_solver<3>(const Parameters&, double);
template class PoissonSolver<2>;
template class PoissonSolver<3>;

}  // namespace strake::fluid
