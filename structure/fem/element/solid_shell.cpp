#include "structure/fem/element/solid_shell.hpp"

#include "proto/error.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace strake::structure::fem {
namespace {

using Eigen::Vector3d;

/// ∂N_a/∂ξ_axis of the trilinear shape functions, nodes in lexicographic order.
Eigen::Matrix<double, 8, 1> shape_gradient(const Vector3d& xi, int axis) {
  Eigen::Matrix<double, 8, 1> gradient;
  for (int a = 0; a < 8; ++a) {
    double product = 0.125;
    for (int k = 0; k < 3; ++k) {
      const double side = (a >> k) & 1 ? 1 : -1;
      product *= k == axis ? side : 1 + side * xi(k);
    }
    gradient(a) = product;
  }
  return gradient;
}

Eigen::Matrix<double, 3, 8> corners(const Mesh<3>& mesh, int cell) {
  Eigen::Matrix<double, 3, 8> X;
  for (int a = 0; a < 8; ++a) X.col(a) = mesh.node.col(mesh.corner(cell, a));
  return X;
}

/// Mean length of the four edges along each axis [m].
Vector3d mean_edges(const Mesh<3>& mesh, int cell) {
  const auto X = corners(mesh, cell);
  Vector3d mean = Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis)
    for (int a = 0; a < 8; ++a)
      if (!((a >> axis) & 1)) mean(axis) += 0.25 * (X.col(a | (1 << axis)) - X.col(a)).norm();
  return mean;
}

/// The shortest of the mean edges, and how many times longer the next one is.
struct Thinness {
  int axis = 0;
  double ratio = 0;
};
Thinness thinness(const Mesh<3>& mesh, int cell) {
  const Vector3d edges = mean_edges(mesh, cell);
  Thinness thin;
  const double least = edges.minCoeff(&thin.axis);
  thin.ratio = std::min(edges((thin.axis + 1) % 3), edges((thin.axis + 2) % 3)) / least;
  return thin;
}

/// A of point q, which lies at ξ: strain components from the samples,
///   E = J⁻ᵀ E_cov J⁻¹,  J = ∂X/∂ξ:
/// a sample E_ij adds its weight times ½ (e_i⊗e_j + e_j⊗e_i), twice where i ≠ j.
Eigen::Matrix<double, 6, SolidShell::samples> interpolation(const SolidShell::Values& X, const Vector3d& xi,
                                                            int q, int thin) {
  const int a = (thin + 1) % 3, b = (thin + 2) % 3;
  Tensor<3> J;
  for (int k = 0; k < 3; ++k) J.col(k) = X * shape_gradient(xi, k);
  const Tensor<3> inverse = J.inverse();
  Eigen::Matrix<double, 6, SolidShell::samples> A = Eigen::Matrix<double, 6, SolidShell::samples>::Zero();
  const auto add = [&](int k, int i, int j, double weight) {
    Tensor<3> M = Tensor<3>::Zero();
    M(i, j) = M(j, i) = weight;
    A.col(k) = strain_components<3>(inverse.transpose() * M * inverse);
  };
  add(3 * q, a, a, 1);
  add(3 * q + 1, b, b, 1);
  add(3 * q + 2, a, b, 1);
  for (const int end : {0, 1}) {
    const int side = 2 * end - 1;
    add(24 + end, a, thin, 0.5 * (1 + side * xi(b)));
    add(26 + end, b, thin, 0.5 * (1 + side * xi(a)));
  }
  for (int corner = 0; corner < 4; ++corner)
    add(28 + corner, thin, thin,
        0.25 * (1 + (2 * (corner & 1) - 1) * xi(a)) * (1 + (2 * (corner >> 1) - 1) * xi(b)));
  return A;
}

}  // namespace

std::vector<int> thin_axes(const Mesh<3>& mesh) {
  std::vector<int> axis(static_cast<std::size_t>(mesh.n_cells()), -1);
  std::vector<char> of_thin(static_cast<std::size_t>(mesh.n_nodes()), 0);
  for (int c = 0; c < mesh.n_cells(); ++c) {
    const Thinness thin = thinness(mesh, c);
    if (1 > thin_ratio * thin.ratio) continue;
    axis[static_cast<std::size_t>(c)] = thin.axis;
    for (int a = 0; a < 8; ++a) of_thin[static_cast<std::size_t>(mesh.cell(a, c))] = 1;
  }
  // The first cell without, of the cells whose neighbours the rank has all.
  Eigen::VectorXd refused = Eigen::VectorXd::Constant(7, -std::numeric_limits<double>::infinity());
  for (int c = mesh.n_cells() - 1; c >= 0; --c) {
    if (axis[static_cast<std::size_t>(c)] >= 0 || !mesh.owns(c)) continue;
    bool meets = false;
    for (int a = 0; a < 8; ++a) meets = meets || of_thin[static_cast<std::size_t>(mesh.cell(a, c))] != 0;
    if (!meets)
      refused << -mesh.number[static_cast<std::size_t>(c)], corners(mesh, c).rowwise().mean(),
          mean_edges(mesh, c);
  }
  refused = mesh.division.largest(refused);
  if (refused.allFinite())
    throw Error(
        ExitCode::case_file, "structure.fem.strain",
        fmt::format(
            "\"solid_shell\" needs cells with one thin direction, and cell {:.0f} at ({:.4g}, {:.4g}, "
            "{:.4g}) m has edges of {:.4g}, {:.4g} and {:.4g} m; no cell beside it is thin either",
            0 - refused(0), refused(1), refused(2), refused(3), refused(4), refused(5), refused(6)),
        "structure.fem.refinement = 0 and a larger structure.fem.cell_size, or structure.fem.strain = "
        "\"auto\"");
  return axis;
}

double slenderness(const Mesh<3>& mesh) {
  double largest = 0;
  for (int c = 0; c < mesh.n_cells(); ++c) largest = std::max(largest, thinness(mesh, c).ratio);
  return mesh.division.max(largest);
}

bool has_core(const Mesh<3>& mesh) {
  constexpr double clearly_thin = 3;
  bool found = false;
  for (int c = 0; c < mesh.n_cells() && !found; ++c) {
    const Thinness thin = thinness(mesh, c);
    if (!mesh.owns(c) || thin.ratio < clearly_thin) continue;  // not where a stiffener stands on a plate
    found = mesh.outside(2 * thin.axis, c) == 0 && mesh.outside(2 * thin.axis + 1, c) == 0;
  }
  return mesh.division.any(found);
}

// The samples: of each point of quadrature E_ξξ, E_ηη, E_ξη (0 to 23), then E_ξζ at η = ∓1 (24, 25), E_ηζ at
// ξ = ∓1 (26, 27), E_ζζ in the four corners (28 to 31).
SolidShell::SolidShell(const Mesh<3>& mesh, int cell, int thin)
    : weight(mesh.weight.data() + cell * nodes), added(std::in_place, mesh, cell, thin) {
  const int a = (thin + 1) % 3, b = (thin + 2) % 3;
  const Values X = corners(mesh, cell);
  const auto set = [&](int k, int i, int j, const Vector3d& xi) {
    const Gradient along_i = shape_gradient(xi, i), along_j = shape_gradient(xi, j);
    sample_[static_cast<std::size_t>(k)] = {along_i, along_j, X * along_i, X * along_j};
  };
  for (int q = 0; q < nodes; ++q) {
    set(3 * q, a, a, mesh.point.col(q));
    set(3 * q + 1, b, b, mesh.point.col(q));
    set(3 * q + 2, a, b, mesh.point.col(q));
    A_[static_cast<std::size_t>(q)] = interpolation(X, mesh.point.col(q), q, thin);
  }
  for (const int end : {0, 1}) {
    set(24 + end, a, thin, (2 * end - 1) * Vector3d::Unit(b));
    set(26 + end, b, thin, (2 * end - 1) * Vector3d::Unit(a));
  }
  for (int corner = 0; corner < 4; ++corner)
    set(28 + corner, thin, thin,
        (2 * (corner & 1) - 1) * Vector3d::Unit(a) + (2 * (corner >> 1) - 1) * Vector3d::Unit(b));
}

// e_k = ½ (G_i·u,j + G_j·u,i + u,i·u,j), the last one for large deformation.
Strains<3, 8> SolidShell::strains(const Values& u, bool large) const {
  Eigen::Matrix<double, samples, 1> e;
  for (int k = 0; k < samples; ++k) {
    const Sample& s = sample_[static_cast<std::size_t>(k)];
    const Vector3d u_i = u * s.along_i, u_j = u * s.along_j;
    e(k) = 0.5 * (s.G_i.dot(u_j) + s.G_j.dot(u_i));
    if (large) e(k) += 0.5 * u_i.dot(u_j);
  }
  Strains<3, 8> E;
  for (std::size_t q = 0; q < E.size(); ++q) E[q] = strain_tensor<3>(Components<3>(A_[q] * e));
  return E;
}

// ∂e_k/∂u_a = ½ (g_i N_a,j + g_j N_a,i), g_i = G_i + u,i for large deformation.
SolidShell::Rows SolidShell::sample_rows(const Values& u, bool large) const {
  Rows B;
  for (int k = 0; k < samples; ++k) {
    const Sample& s = sample_[static_cast<std::size_t>(k)];
    Vector3d g_i = s.G_i, g_j = s.G_j;
    if (large) g_i += u * s.along_i;
    if (large) g_j += u * s.along_j;
    for (int a = 0; a < nodes; ++a)
      B.block<1, 3>(k, 3 * a) = 0.5 * (g_i * s.along_j(a) + g_j * s.along_i(a)).transpose();
  }
  return B;
}

Eigen::Matrix<double, SolidShell::samples, 1> SolidShell::stresses(const Strains<3, 8>& S) const {
  Eigen::Matrix<double, samples, 1> sum = Eigen::Matrix<double, samples, 1>::Zero();
  for (std::size_t q = 0; q < S.size(); ++q)
    sum.noalias() += A_[q].transpose() * (weight[q] * stress_components<3>(S[q]));
  return sum;
}

// f = Σ_k ∂e_k/∂u Σ_q w A_kᵀ S.
SolidShell::Values SolidShell::forces(const Values& u, const Strains<3, 8>& S, bool large) const {
  return (sample_rows(u, large).transpose() * stresses(S)).reshaped(3, nodes);
}

// Σ_k s_k ½ (∇_i ∇_jᵀ + ∇_j ∇_iᵀ) with s_k = Σ w A_kᵀ S.
Eigen::Matrix<double, 8, 8> SolidShell::geometric(const Strains<3, 8>& S) const {
  const auto s = stresses(S);
  Eigen::Matrix<double, 8, 8> between = Eigen::Matrix<double, 8, 8>::Zero();
  for (int k = 0; k < samples; ++k) {
    const Sample& at = sample_[static_cast<std::size_t>(k)];
    const Eigen::Matrix<double, 8, 8> outer = 0.5 * s(k) * at.along_i * at.along_j.transpose();
    between += outer + outer.transpose();
  }
  return between;
}

}  // namespace strake::structure::fem
