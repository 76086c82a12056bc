#pragma once

#include "structure/particle/lattice.hpp"

#include <Eigen/Core>

#include <vector>

namespace strake::structure {

/// The fixed neighbours of the reference lattice, rows sorted by index (CSR), with all that depends on it
/// alone. Weight w⁰ = r_e/|r⁰| − 1 (PHYSICS §2, eq. 17).
struct Bonds {
  std::vector<Eigen::Index> start;      // n+1
  std::vector<Eigen::Index> neighbour;  // m
  Eigen::Matrix2Xd r0;                  // 2×m [m] r⁰_ij = r⁰_j − r⁰_i
  Eigen::VectorXd weight;               // m
  double n0 = 0;                        // Σ w⁰ of the full lattice
  Eigen::Matrix4Xd shape_inverse;       // 4×n [1/m²] A_i⁻¹ of A_i = Σ_j w⁰ r⁰⊗r⁰, column-major
  Eigen::VectorXd second_moment;        // n [m²] Σ_j w⁰ |r⁰|² = tr A_i

  Eigen::Index size() const { return second_moment.size(); }
};
Bonds make_bonds(const Lattice&, double radius /* [spacing] */);

/// H_i = F_i − 1 of the corrected total-Lagrangian form, 4×n, column-major:
///   F_i = (Σ_j w⁰ r_ij⊗r⁰_ij) A_i⁻¹ ,  r_ij = r⁰_ij + u_j − u_i      (exact for linear fields)
Eigen::Matrix4Xd displacement_gradient(const Bonds&, const Eigen::Matrix2Xd& displacement);

/// Loops over fewer particles than this run on one thread: waking the others costs more than the work.
inline constexpr Eigen::Index parallel_from = 4000;

}  // namespace strake::structure
