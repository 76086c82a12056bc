#pragma once

#include "structure/fem/element/cell.hpp"
#include "structure/fem/element/enhanced.hpp"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <vector>

namespace strake::structure::fem {

/// For each cell the axis 0, 1 or 2 along which it is thin: its mean edge is at most `thin_ratio` of the next
/// longer one. −1: a joint, as where a stiffener as wide as the plate is thick stands on it. Such a cell has
/// no thin direction, but shares nodes with cells that have. Throws Error(case_file) for a cell that shares
/// none.
inline constexpr double thin_ratio = 0.75;
std::vector<int> thin_axes(const Mesh<3>&);

/// How many times longer the second shortest of a cell's mean edges is than the shortest; the largest of all.
double slenderness(const Mesh<3>&);
/// Whether a cell lies between two others along its shortest edges: three or more through the thickness.
bool has_core(const Mesh<3>&);

/// Computes a solid shell: a hexahedron of eight nodes for plates that are one cell thick
/// (structure/THEORY.md (S41) to (S44)). ζ is the thin direction, ξ and η lie in the plane, all in [−1, 1].
/// G_i are the covariant base vectors of the mapping, and E_ij = ½ (G_i·u,j + G_j·u,i + u,i·u,j) the
/// covariant strains.
///
///   E_ξζ = ½ (1−η) E_ξζ(0,−1,0) + ½ (1+η) E_ξζ(0,1,0), E_ηζ likewise           (Dvorkin & Bathe 1984)
///   E_ζζ = Σ_corners ¼ (1 ± ξ)(1 ± η) E_ζζ(±1,±1,0)                            (Betsch & Stein 1995)
///   E_ξξ, E_ηη, E_ξη of the displacement, and strains beside them: ξ in ξξ, η in ηη, ξ and η in ξη, and
///   ζ, ξζ, ηζ in ζζ                          (Simo & Rifai 1990; seven, as Vu-Quoc & Tan 2003 have them)
///
/// So all assumed strains are a constant matrix A times 32 sampled ones e_k, each quadratic in u. The mean of
/// two displacements then has Σ_k ∂e_k/∂u Δu = Δe_k exactly, and the balance of energy (S15) stays.
class SolidShell {
 public:
  static constexpr int dimension = 3, nodes = 8, samples = 32;
  using Values = NodeValues<3, 8>;
  using Motion = Values;

  /// `thin`: axis of the cell that is ζ.
  SolidShell(const Mesh<3>&, int cell, int thin);
  const double* weight;  // of the points of quadrature
  std::optional<EnhancedStrain<3, nodes>> added;

  /// As Continuum has them: of E in the points of quadrature without the enhanced strains.
  const Motion& motion(const Values& u) const { return u; }
  Strains<3, 8> strains(const Values& u, bool large) const;
  auto rows(const Values& u, bool large) const {
    return [this, along = sample_rows(u, large)](int q) { return A_[static_cast<std::size_t>(q)] * along; };
  }
  Values forces(const Values& u, const Strains<3, 8>& S, bool large) const;
  Eigen::Matrix<double, 8, 8> geometric(const Strains<3, 8>& S) const;

 private:
  using Gradient = Eigen::Matrix<double, nodes, 1>;  // of the shape functions along one axis
  using Rows = Eigen::Matrix<double, samples, 3 * nodes>;
  using Components6 = Eigen::Matrix<double, 6, samples>;
  /// A covariant strain E_ij in one point of the reference cell.
  struct Sample {
    Gradient along_i, along_j;
    Eigen::Vector3d G_i, G_j;
  };

  Rows sample_rows(const Values& u, bool large) const;                       // ∂e_k/∂u at u
  Eigen::Matrix<double, samples, 1> stresses(const Strains<3, 8>& S) const;  // Σ w Aᵀ S

  std::array<Sample, samples> sample_;
  std::array<Components6, nodes> A_;  // of each point: strain components from samples
};

}  // namespace strake::structure::fem
