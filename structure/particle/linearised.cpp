#include "structure/particle/linearised.hpp"

#include "proto/error.hpp"
#include "structure/particle/linear/frequencies.hpp"
#include "structure/particle/linear/saddle_point_solver.hpp"

#include <algorithm>

namespace strake::structure {
namespace {

/// Number of a free particle's first unknown, or -1.
template <int dim>
std::vector<int> unknowns(const Lattice<dim>& lattice) {
  std::vector<int> number(static_cast<std::size_t>(lattice.size()), -1);
  int next = 0;
  for (std::size_t i = 0; i < number.size(); ++i)
    if (!lattice.fixed[i]) number[i] = dim * next++;
  return number;
}

template <int dim>
int count_unknowns(const Lattice<dim>& lattice) {
  return dim * static_cast<int>(std::count(lattice.fixed.begin(), lattice.fixed.end(), 0));
}

template <int dim>
Eigen::VectorXd gather(const Lattice<dim>& lattice, const Vectors<dim>& full) {
  Eigen::VectorXd x(count_unknowns(lattice));
  Eigen::Index at = 0;
  for (Eigen::Index i = 0; i < lattice.size(); ++i)
    if (!lattice.fixed[static_cast<std::size_t>(i)]) {
      x.template segment<dim>(at) = full.col(i);
      at += dim;
    }
  return x;
}

template <int dim>
Vectors<dim> scatter(const Lattice<dim>& lattice, const Eigen::VectorXd& x) {
  Vectors<dim> full = Vectors<dim>::Zero(dim, lattice.size());
  Eigen::Index at = 0;
  for (Eigen::Index i = 0; i < lattice.size(); ++i)
    if (!lattice.fixed[static_cast<std::size_t>(i)]) {
      full.col(i) = x.template segment<dim>(at);
      at += dim;
    }
  return full;
}

}  // namespace

// Computes K by differences, many particles at once. Particles further apart than twice the influence along
// any axis have no force in common.
template <int dim>
Eigen::SparseMatrix<double> stiffness(const ElasticModel<dim>& model, const Lattice<dim>& lattice,
                                      const Vectors<dim>& u) {
  using Cell = typename Lattice<dim>::Cell;
  const std::vector<int> number = unknowns<dim>(lattice);
  const int reach = model.influence();
  const Cell period = lattice.extent.cwiseMin(2 * reach + 1);
  std::vector<std::vector<Eigen::Index>> colours(static_cast<std::size_t>(period.prod()));
  for (Eigen::Index i = 0; i < lattice.size(); ++i) {
    if (lattice.fixed[static_cast<std::size_t>(i)]) continue;
    std::size_t colour = 0;
    for (int axis = 0; axis < dim; ++axis)
      colour = colour * static_cast<std::size_t>(period[axis]) +
               static_cast<std::size_t>(lattice.cell(axis, i) % period[axis]);
    colours[colour].push_back(i);
  }
  const double step = difference_step * lattice.spacing;
  std::vector<Eigen::Triplet<double>> entries;
  for (const std::vector<Eigen::Index>& together : colours)
    for (int axis = 0; axis < dim && !together.empty(); ++axis) {
      Vectors<dim> plus = u, minus = u;
      for (const Eigen::Index i : together) {
        plus(axis, i) += step;
        minus(axis, i) -= step;
      }
      const Vectors<dim> column = (model.force(minus) - model.force(plus)) / (2 * step);
      for (const Eigen::Index i : together) {
        const Cell here = lattice.cell.col(i);
        const Cell low = (here.array() - reach).max(0),
                   high = (here.array() + reach + 1).min(lattice.extent.array());
        for_each_cell<dim>(low, high, [&](const Cell& at) {
          const Eigen::Index k = lattice.index(at);
          if (k < 0 || number[static_cast<std::size_t>(k)] < 0) return;
          for (int a = 0; a < dim; ++a)
            if (column(a, k) != 0)
              entries.emplace_back(number[static_cast<std::size_t>(k)] + a,
                                   number[static_cast<std::size_t>(i)] + axis, column(a, k));
        });
      }
    }
  const int n = count_unknowns<dim>(lattice);
  Eigen::SparseMatrix<double> K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

template <int dim>
Vectors<dim> equilibrium(const ElasticModel<dim>& model, const Lattice<dim>& lattice,
                         const Constraints<dim>& supports, const Vectors<dim>& force) {
  constexpr int max_iterations = 30;
  constexpr double tolerance = 1e-9;  // of the increment, relative to the displacement
  Vectors<dim> u = Vectors<dim>::Zero(dim, lattice.size());
  const SparseRows C = supports.rows(unknowns<dim>(lattice), count_unknowns<dim>(lattice));
  SaddlePointSolver solver;
  for (int k = 0; k < max_iterations; ++k) {
    solver.factorise(stiffness<dim>(model, lattice, u), C);
    const Eigen::VectorXd increment = solver.solve(gather<dim>(lattice, model.force(u) + force));
    if (!increment.allFinite()) break;
    u += scatter<dim>(lattice, increment);
    if (increment.lpNorm<Eigen::Infinity>() <= tolerance * u.template lpNorm<Eigen::Infinity>()) return u;
  }
  throw Error(ExitCode::solver_fault, "structure, particle", "no equilibrium found under the case's own load",
              "lower structure.load.value, or structure.analysis = \"dynamic\" with structure.load.ramp");
}

template <int dim>
std::vector<double> natural_frequencies(const ElasticModel<dim>& model, const Lattice<dim>& lattice,
                                        const Constraints<dim>& supports, const Eigen::VectorXd& mass,
                                        double scale, int count) {
  return lowest_frequencies(
      {.stiffness = stiffness<dim>(model, lattice, Vectors<dim>::Zero(dim, lattice.size())),
       .mass = gather<dim>(lattice, mass.transpose().template replicate<dim, 1>()),
       .equations = supports.rows(unknowns<dim>(lattice), count_unknowns<dim>(lattice)),
       .rigid_motions = dim == 2 ? 3 : 6},
      scale, count);
}

template Eigen::SparseMatrix<double> stiffness<2>(const ElasticModel<2>&, const Lattice<2>&,
                                                  const Vectors<2>&);
template Eigen::SparseMatrix<double> stiffness<3>(const ElasticModel<3>&, const Lattice<3>&,
                                                  const Vectors<3>&);
template Vectors<2> equilibrium<2>(const ElasticModel<2>&, const Lattice<2>&, const Constraints<2>&,
                                   const Vectors<2>&);
template Vectors<3> equilibrium<3>(const ElasticModel<3>&, const Lattice<3>&, const Constraints<3>&,
                                   const Vectors<3>&);
template std::vector<double> natural_frequencies<2>(const ElasticModel<2>&, const Lattice<2>&,
                                                    const Constraints<2>&, const Eigen::VectorXd&, double,
                                                    int);
template std::vector<double> natural_frequencies<3>(const ElasticModel<3>&, const Lattice<3>&,
                                                    const Constraints<3>&, const Eigen::VectorXd&, double,
                                                    int);

}  // namespace strake::structure
