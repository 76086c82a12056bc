#include "structure/particle/total_lagrangian.hpp"

#include "structure/material/material.hpp"

#include <algorithm>

namespace strake::structure {
namespace {

/// The largest distance of two neighbours along an axis, in lattice cells.
template <int dim>
int reach_of(const Lattice<dim>& lattice, const Bonds<dim>& bonds) {
  int reach = 0;
  for (Eigen::Index i = 0; i < bonds.size(); ++i)
    for (Eigen::Index b = bonds.first(i); b < bonds.end(i); ++b)
      reach = std::max(reach, (lattice.cell.col(bonds.to(b)) - lattice.cell.col(i)).cwiseAbs().maxCoeff());
  return reach;
}

}  // namespace

template <int dim>
TotalLagrangian<dim>::TotalLagrangian(const Lattice<dim>& lattice, const Bonds<dim>& bonds, double hourglass)
    : lattice_(lattice), bonds_(bonds), stiffness_(bonds.size()), influence_(2 * reach_of(lattice, bonds)) {
  for (Eigen::Index i = 0; i < bonds.size(); ++i)
    stiffness_[i] = hourglass * lattice.material(i).young * lattice.volume(i);
}

/// κ_i [Pa] ([Pa m]), less what softening took.
template <int dim>
Eigen::VectorXd TotalLagrangian<dim>::penalties() const {
  return stiffness_.array() * bonds_.inverse_moment.array() * bonds_.integrity.array();
}

//   f_i = Σ_j w⁰ [(V P_i A_i⁻¹ + V P_j A_j⁻¹) r⁰_ij + κ_i e_ij − κ_j e_ji]
// With H = F − 1 and u_ij = u_j − u_i, e_ij = u_ij − H_i r⁰_ij and e_ji = −u_ij + H_j r⁰_ij, hence
//   f_i = Σ_j w⁰ [(T_i + T_j) r⁰_ij + (κ_i + κ_j) u_ij],   T_i = V P_i A_i⁻¹ − κ_i H_i.
template <int dim>
Vectors<dim> TotalLagrangian<dim>::force(const Vectors<dim>& u) const {
  using Matrix = Eigen::Matrix<double, dim, dim>;
  const Eigen::Index n = bonds_.size();
  const Eigen::VectorXd penalty = penalties();
  Tensors<dim> T = displacement_gradient<dim>(bonds_, u);
#pragma omp parallel for schedule(static) if (n >= parallel_from)
  for (Eigen::Index i = 0; i < n; ++i) {
    const Matrix H = Eigen::Map<const Matrix>(T.col(i).data()),
                 A = Eigen::Map<const Matrix>(bonds_.shape_inverse.col(i).data());
    const Matrix F = Matrix::Identity() + H;
    Eigen::Map<Matrix>(T.col(i).data()) =
        lattice_.volume(i) * bonds_.integrity[i] * first_piola_kirchhoff<dim>(lattice_.material(i), F) * A -
        penalty[i] * H;
  }

  Vectors<dim> f(dim, n);
#pragma omp parallel for schedule(static) if (n >= parallel_from)
  for (Eigen::Index i = 0; i < n; ++i) {
    double sum[dim] = {};
    for (Eigen::Index b = bonds_.first(i); b < bonds_.end(i); ++b) {
      const Eigen::Index j = bonds_.to(b);
      const double w = bonds_.weight[b], kappa = penalty[i] + penalty[j];
      for (int k = 0; k < dim; ++k) {
        double pull = 0;
        for (int l = 0; l < dim; ++l) pull += (T(l * dim + k, i) + T(l * dim + k, j)) * bonds_.r0(l, b);
        sum[k] += w * (pull + kappa * (u(k, j) - u(k, i)));
      }
    }
    for (int k = 0; k < dim; ++k) f(k, i) = sum[k];
  }
  return f;
}

template <int dim>
double TotalLagrangian<dim>::energy(const Vectors<dim>& u) const {
  using Matrix = Eigen::Matrix<double, dim, dim>;
  const Eigen::VectorXd penalty = penalties();
  const Tensors<dim> H = displacement_gradient<dim>(bonds_, u);
  double total = 0;
  for (Eigen::Index i = 0; i < bonds_.size(); ++i) {
    const Matrix Hi = Eigen::Map<const Matrix>(H.col(i).data()), F = Matrix::Identity() + Hi;
    double hourglass = 0;
    for (Eigen::Index b = bonds_.first(i); b < bonds_.end(i); ++b)
      hourglass += bonds_.weight[b] * (u.col(bonds_.to(b)) - u.col(i) - Hi * bonds_.r0.col(b)).squaredNorm();
    total += lattice_.volume(i) * bonds_.integrity[i] * energy_density<dim>(lattice_.material(i), F) +
             0.5 * penalty[i] * hourglass;
  }
  return total;
}

template class TotalLagrangian<2>;
template class TotalLagrangian<3>;

}  // namespace strake::structure
