#include "fluid/pressure_solver/ranked_pressure.hpp"

#include "fluid/pressure_solver/poisson_solver.hpp"
#include "fluid/pressure_solver/sealed_blocks.hpp"

#include <omp.h>

namespace strake::fluid {

template <int dim>
bool RankedPressure<dim>::solve(const PressureSystem& local, const Vectors<dim>& position,
                                const Eigen::VectorXd& guess, bool may_be_sealed, const Scheme& scheme,
                                PressureSolution& solution) {
  Communicator& communicator = subdomain_.communicator();
  unknowns_.take(local, subdomain_, position, system_);
  const bool sealed = may_be_sealed && close_sealed_blocks(system_, unknowns_, subdomain_.places()) > 0;
  own_.pressure.resize(unknowns_.near);
  for (std::int64_t k = 0; k < unknowns_.near; ++k)
    own_.pressure[k] = guess[unknowns_.particle[static_cast<std::size_t>(k)]];
  const bool grids =
      unknowns_.has_grid &&
      choose_pressure_solver(system_, scheme, communicator).preconditioner == Preconditioner::multilevel;
  const int threads = omp_get_max_threads();
  double full = 1;
  for (int d = 0; d < dim; ++d) full *= subdomain_.bucket_size()[d] / spacing_;
  if (grids) multilevel_.build(system_, unknowns_, grid_, full, threads);
  const SolvingRanks ranks{communicator, unknowns_.halo, unknowns_.near};
  cg_.solve<dim>(system_, grids ? &multilevel_ : nullptr, scheme.pressure_tolerance,
                 scheme.pressure_max_iterations, threads, own_, &ranks);
  solution.iterations = own_.iterations;
  solution.residual = own_.residual;
  // A particle without neighbours has a row of its own.
  solution.pressure = (local.diagonal.array() > 0).select(local.right.array() / local.diagonal.array(), 0.0);
  for (std::int64_t k = 0; k < unknowns_.own; ++k)
    solution.pressure[unknowns_.particle[static_cast<std::size_t>(k)]] = own_.pressure[k];
  return sealed;
}

template class RankedPressure<2>;
template class RankedPressure<3>;

}  // namespace strake::fluid
