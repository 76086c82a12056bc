#pragma once

#include "structure/particle/constraints.hpp"
#include "structure/particle/elastic_model.hpp"
#include "structure/particle/lattice.hpp"

#include <Eigen/SparseCore>

#include <limits>
#include <vector>

namespace strake::structure {

/// Step of the central differences in spacings. The forces are smooth on the scale of a bond, so that
/// truncation (1e-12) and round-off (1e-16/1e-5) are both far below what is asked of K.
inline constexpr double difference_step = 1e-5;

/// K = −∂f/∂u at a displacement, over the free particles (their components in lattice order) [N/m].
template <int dim>
Eigen::SparseMatrix<double> stiffness(const ElasticModel<dim>&, const Lattice<dim>&,
                                      const Vectors<dim>& displacement);

/// Displacement in equilibrium with a given force [N], fixed particles and supports at rest: Newton's method.
/// Throws Error(solver_fault) when it does not converge.
template <int dim>
Vectors<dim> equilibrium(const ElasticModel<dim>&, const Lattice<dim>&, const Constraints<dim>&,
                         const Vectors<dim>& force);

/// The lowest `count` natural frequencies [Hz] about the reference, ascending, rigid motions left out.
/// `mass` of each particle [kg]; `scale` [Hz] a frequency of the order of the first.
template <int dim>
std::vector<double> natural_frequencies(const ElasticModel<dim>&, const Lattice<dim>&,
                                        const Constraints<dim>&, const Eigen::VectorXd& mass, double scale,
                                        int count);

/// Largest stable step of leapfrog about the reference, 2/ω_max [s], by power iteration. `frame_mass` [kg]
/// along each axis: mass of the frame with which all fixed particles move; infinite where its motion is
/// prescribed.
template <int dim>
double elastic_limit(const ElasticModel<dim>&, const Lattice<dim>&, const Eigen::VectorXd& mass,
                     const Eigen::Matrix<double, dim, 1>& frame_mass =
                         Eigen::Matrix<double, dim, 1>::Constant(std::numeric_limits<double>::infinity()));

}  // namespace strake::structure
