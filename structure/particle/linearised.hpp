#pragma once

#include "structure/particle/elastic_model.hpp"
#include "structure/particle/lattice.hpp"

#include <Eigen/SparseCore>

#include <vector>

namespace strake::structure {

/// K = −∂f/∂u at a displacement, over the free particles (x and y of each, in lattice order) [N/m²].
Eigen::SparseMatrix<double> stiffness(const ElasticModel&, const Lattice&,
                                      const Eigen::Matrix2Xd& displacement);

/// Displacement in equilibrium with a given force 2×n [N/m], fixed particles at rest: Newton's method.
/// Throws Error(solver_fault) when it does not converge.
Eigen::Matrix2Xd equilibrium(const ElasticModel&, const Lattice&, const Eigen::Matrix2Xd& force);

/// The lowest `count` natural frequencies [Hz] about the reference, ascending, rigid motions left out.
/// `mass` of one particle [kg/m]; `scale` [Hz] a frequency of the order of the first.
std::vector<double> natural_frequencies(const ElasticModel&, const Lattice&, double mass, double scale,
                                        int count);

/// Largest stable step of leapfrog about the reference, 2/ω_max [s], by power iteration.
double elastic_limit(const ElasticModel&, const Lattice&, double mass);

}  // namespace strake::structure
