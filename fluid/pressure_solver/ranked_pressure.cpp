#include "fluid/pressure_solver/ranked_pressure.hpp"

#include "fluid/pressure_solver/poisson_solver.hpp"
#include "fluid/pressure_solver/sealed_blocks.hpp"

#include <omp.h>

namespace strake::fluid {

template <int dim>
bool RankedPressure<dim>::solve(PressureSystem& local, const Vectors<dim>& position,
                                const Eigen::VectorXd& guess, bool may_be_sealed, const Scheme& scheme,
                                PressureSolution& solution) {
  Communicator& communicator = subdomain_.communicator();
  unknowns_.take(local, subdomain_, position);
  const bool sealed = may_be_sealed && close_sealed_blocks(local, unknowns_) > 0;
  solution.pressure = guess.head(local.size());
  const bool grids =
      unknowns_.has_grid &&
      choose_pressure_solver(local, scheme, communicator).preconditioner == Preconditioner::multilevel;
  const int threads = omp_get_max_threads();
  double full = 1;
  for (int d = 0; d < dim; ++d) full *= subdomain_.buckets().size()[d] / spacing_;
  if (grids) multilevel_.build(local, unknowns_, grid_, full, threads);
  const SolvingRanks ranks{communicator, *unknowns_.halo};
  cg_.solve<dim>(local, grids ? &multilevel_ : nullptr, scheme.pressure_tolerance,
                 scheme.pressure_max_iterations, threads, solution, &ranks);
  return sealed;
}

template class RankedPressure<2>;
template class RankedPressure<3>;

}  // namespace strake::fluid
