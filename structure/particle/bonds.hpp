#pragma once

#include "structure/particle/lattice.hpp"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace strake::structure {

template <int dim>
using Tensors = Eigen::Matrix<double, dim * dim, Eigen::Dynamic>;  // one column-major tensor per particle

/// The fixed neighbours of the reference configuration, rows sorted by index (CSR), with all that depends on
/// them alone. Weight w⁰ = r_e/|r⁰| − 1 (structure/THEORY.md (S18)). Bonds do not cross gaps of the body:
/// between two neighbours there is a path through lattice cells that share faces.
template <int dim>
struct Bonds {
  std::vector<Eigen::Index> start;      // n+1
  std::vector<Eigen::Index> neighbour;  // m
  Vectors<dim> r0;                      // dim×m [m] r⁰_ij = r⁰_j − r⁰_i
  Eigen::VectorXd weight;               // m; 0: broken
  double n0 = 0;                        // Σ w⁰ of the full lattice
  double radius = 0;                    // [spacing]
  Tensors<dim> shape_inverse;           // [1/m²] A_i⁻¹ of A_i = Σ_j w⁰ r⁰⊗r⁰, column-major
  Eigen::VectorXd inverse_moment;       // n [1/m²] (dim/2)/Σ_j w⁰ |r⁰|²
  Eigen::VectorXd integrity;            // n share of its stress that a particle still carries, 1: intact

  Eigen::Index size() const { return inverse_moment.size(); }
  Eigen::Index first(Eigen::Index i) const { return start[static_cast<std::size_t>(i)]; }
  Eigen::Index end(Eigen::Index i) const { return start[static_cast<std::size_t>(i) + 1]; }
  Eigen::Index to(Eigen::Index bond) const { return neighbour[static_cast<std::size_t>(bond)]; }
};
template <int dim>
Bonds<dim> make_bonds(const Lattice<dim>&, double radius /* [spacing] */);

/// Finds A_i⁻¹ and the moment of a particle from the weights of its bonds. Where bonds broke and those left
/// do not span the space it carries nothing any more: both are zero.
template <int dim>
void find_shape(Bonds<dim>&, Eigen::Index i);

/// H_i = F_i − 1 of the corrected total-Lagrangian form, column-major:
///   F_i = (Σ_j w⁰ r_ij⊗r⁰_ij) A_i⁻¹ ,  r_ij = r⁰_ij + u_j − u_i      (exact for linear fields)
template <int dim>
Tensors<dim> displacement_gradient(const Bonds<dim>&, const Vectors<dim>& displacement);

/// Weights of the particles' stresses at a place of the body, n: the least-squares linear field through those
/// around that have bonds on all sides (structure/THEORY.md (S45)). Empty where there are too few of the same
/// part.
template <int dim>
std::optional<Eigen::VectorXd> extrapolation(const Lattice<dim>&, const Bonds<dim>&,
                                             const Eigen::Vector3d& X);

/// Loops over fewer particles than this run on one thread: waking the others costs more than the work.
inline constexpr Eigen::Index parallel_from = 4000;

}  // namespace strake::structure
