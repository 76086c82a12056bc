#include "structure/particle/bonds.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <cmath>

namespace strake::structure {
namespace {

/// True if lattice cells that share faces lead from `a` to `b` without a detour.
template <int dim>
bool hang_together(const Lattice<dim>& lattice, const Eigen::Matrix<int, dim, 1>& a,
                   const Eigen::Matrix<int, dim, 1>& b) {
  if (a == b) return true;
  for (int axis = 0; axis < dim; ++axis) {
    if (a[axis] == b[axis]) continue;
    Eigen::Matrix<int, dim, 1> next = a;
    next[axis] += b[axis] > a[axis] ? 1 : -1;
    if (lattice.index(next) >= 0 && hang_together<dim>(lattice, next, b)) return true;
  }
  return false;
}

template <int dim>
double length_of(const Eigen::Matrix<int, dim, 1>& offset) {
  if constexpr (dim == 2)
    return std::hypot(offset[0], offset[1]);
  else
    return std::sqrt(static_cast<double>(offset.squaredNorm()));
}

}  // namespace

template <int dim>
Bonds<dim> make_bonds(const Lattice<dim>& lattice, double radius) {
  using Cell = Eigen::Matrix<int, dim, 1>;
  // Two particles that stand beside the middles of their cells may be nearer than these.
  const double nearer = 2 * std::sqrt(lattice.shift.colwise().squaredNorm().maxCoeff());
  const int reach = static_cast<int>(std::floor(radius + nearer)), width = 2 * reach + 1;
  struct Offset {
    Cell to;
    double length;  // [spacing]
  };
  Bonds<dim> bonds;
  std::vector<Offset> offsets;
  for (int k = 0; k < (dim == 2 ? width * width : width * width * width);
       ++k) {  // x slowest, as particles are
    Cell to;
    for (int axis = dim - 1, rest = k; axis >= 0; --axis, rest /= width) to[axis] = rest % width - reach;
    const double r = length_of<dim>(to);
    if (!(r > 0 && r < radius + nearer)) continue;
    offsets.push_back({to, r});
    if (r < radius) bonds.n0 += radius / r - 1;
  }

  const Eigen::Index n = lattice.size();
  std::vector<double> r0, w;
  bonds.radius = radius;
  bonds.start.push_back(0);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Cell here = lattice.cell.col(i);
    for (const Offset& offset : offsets) {
      const Cell there = here + offset.to;
      const Eigen::Index j = lattice.index(there);
      if (j < 0) continue;
      const Eigen::Matrix<double, dim, 1> beside = lattice.shift.col(j) - lattice.shift.col(i);
      const double length =
          beside.isZero(0) ? offset.length : (offset.to.template cast<double>() + beside).norm();
      if (!(length < radius) || !hang_together<dim>(lattice, here, there)) continue;
      const Eigen::Matrix<double, dim, 1> r = (offset.to.template cast<double>() + beside) * lattice.spacing;
      bonds.neighbour.push_back(j);
      r0.insert(r0.end(), r.data(), r.data() + dim);
      w.push_back(radius / length - 1);
    }
    bonds.start.push_back(static_cast<Eigen::Index>(bonds.neighbour.size()));
  }
  const auto m = static_cast<Eigen::Index>(w.size());
  bonds.r0 = Eigen::Map<const Vectors<dim>>(r0.data(), dim, m);
  bonds.weight = Eigen::Map<const Eigen::VectorXd>(w.data(), m);
  bonds.shape_inverse.resize(dim * dim, n);
  bonds.inverse_moment.resize(n);
  bonds.integrity = Eigen::VectorXd::Ones(n);
  for (Eigen::Index i = 0; i < n; ++i) find_shape<dim>(bonds, i);
  return bonds;
}

template <int dim>
void find_shape(Bonds<dim>& bonds, Eigen::Index i) {
  using Matrix = Eigen::Matrix<double, dim, dim>;
  constexpr double thin = 0.02;  // least over largest eigenvalue: a corner of a lattice has 0.5
  Matrix shape = Matrix::Zero();
  bool broken = false;
  for (Eigen::Index b = bonds.first(i); b < bonds.end(i); ++b) {
    shape += bonds.weight[b] * bonds.r0.col(b) * bonds.r0.col(b).transpose();
    broken = broken || bonds.weight[b] == 0;
  }
  Eigen::Map<Matrix> inverse(bonds.shape_inverse.col(i).data());
  if (broken) {
    const auto values = Eigen::SelfAdjointEigenSolver<Matrix>(shape, Eigen::EigenvaluesOnly).eigenvalues();
    if (!(values.minCoeff() > thin * values.maxCoeff())) {
      inverse.setZero();
      bonds.inverse_moment[i] = 0;
      return;
    }
  }
  inverse = shape.inverse();
  bonds.inverse_moment[i] = 0.5 * dim / shape.trace();
}

template <int dim>
Tensors<dim> displacement_gradient(const Bonds<dim>& bonds, const Vectors<dim>& u) {
  const Eigen::Index n = bonds.size();
  Tensors<dim> H(dim * dim, n);
#pragma omp parallel for schedule(static) if (n >= parallel_from)
  for (Eigen::Index i = 0; i < n; ++i) {
    double sum[dim][dim] = {};  // Σ w⁰ (u_j − u_i)⊗r⁰_ij
    for (Eigen::Index b = bonds.first(i); b < bonds.end(i); ++b) {
      const Eigen::Index j = bonds.to(b);
      double du[dim];
      for (int k = 0; k < dim; ++k) du[k] = u(k, j) - u(k, i);
      for (int l = 0; l < dim; ++l) {
        const double along = bonds.weight[b] * bonds.r0(l, b);
        for (int k = 0; k < dim; ++k) sum[k][l] += du[k] * along;
      }
    }
    const auto A = bonds.shape_inverse.col(i);
    for (int l = 0; l < dim; ++l)
      for (int k = 0; k < dim; ++k) {
        double value = 0;
        for (int q = 0; q < dim; ++q) value += sum[k][q] * A[l * dim + q];
        H(l * dim + k, i) = value;
      }
  }
  return H;
}

template Bonds<2> make_bonds<2>(const Lattice<2>&, double);
template Bonds<3> make_bonds<3>(const Lattice<3>&, double);
template void find_shape<2>(Bonds<2>&, Eigen::Index);
template void find_shape<3>(Bonds<3>&, Eigen::Index);
template Tensors<2> displacement_gradient<2>(const Bonds<2>&, const Vectors<2>&);
template Tensors<3> displacement_gradient<3>(const Bonds<3>&, const Vectors<3>&);

}  // namespace strake::structure
