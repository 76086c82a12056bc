#pragma once

#include "fluid/particles/shared_memory.hpp"
#include "fluid/pressure_solver/multilevel.hpp"
#include "fluid/pressure_solver/pressure_system.hpp"
#include "fluid/ranks/halo.hpp"

#include <vector>

namespace strake::fluid {

/// The ranks that solve one equation together. Each has the rows of its own unknowns. The rows of copies are
/// empty, with neither diagonal nor right side.
struct SolvingRanks {
  Communicator& communicator;
  const Halo& halo;  // gives copies the values of their owners
};

/// Solves by conjugate gradients, in one parallel region per solve. Sums are computed over blocks of rows,
/// each by one thread, and added in order: the result is the same for any number of threads.
class ConjugateGradients {
 public:
  /// Iterates from solution.pressure to ‖b − A p‖₂ <= tolerance ‖b‖₂. preconditioner: built for this system;
  /// nullptr: the diagonal. Ends as soon as the residual is no number. ranks: nullptr: there is one. On
  /// several ranks the sums are the same for any number of threads, not for any number of ranks.
  template <int dim>
  void solve(const PressureSystem&, Multilevel<dim>* preconditioner, double tolerance, int max_iterations,
             int threads, PressureSolution& solution, const SolvingRanks* ranks = nullptr);
  std::size_t bytes() const { return memory_.bytes(); }
  SharedMemory& memory() { return memory_; }  // nothing is kept in it

 private:
  SharedMemory memory_;                         // inverse diagonal, r, p, q
  std::vector<double> first_, second_, third_;  // sums of each block
};

/// Returns (A x)_k.
double row_times(const PressureSystem&, const double* x, std::int64_t k);

}  // namespace strake::fluid
