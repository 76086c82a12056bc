#include "structure/particle/bonds.hpp"

#include <Eigen/LU>

#include <cmath>

namespace strake::structure {

Bonds make_bonds(const Lattice& lattice, double radius) {
  const int reach = static_cast<int>(std::floor(radius));
  const double d = lattice.spacing;
  const auto weight = [radius](int dc, int dl) {
    const double r = std::hypot(dc, dl);
    return r > 0 && r < radius ? radius / r - 1 : 0.0;
  };

  Bonds bonds;
  for (int dc = -reach; dc <= reach; ++dc)
    for (int dl = -reach; dl <= reach; ++dl) bonds.n0 += weight(dc, dl);

  std::vector<Eigen::Vector2d> r0;
  std::vector<double> w;
  bonds.start.push_back(0);
  bonds.shape_inverse.resize(4, lattice.size());
  bonds.second_moment = Eigen::VectorXd::Zero(lattice.size());
  for (int c = 0; c < lattice.columns; ++c) {
    for (int l = 0; l < lattice.layers; ++l) {
      const Eigen::Index i = lattice.index(c, l);
      Eigen::Matrix2d shape = Eigen::Matrix2d::Zero();
      for (int dc = -reach; dc <= reach; ++dc) {
        for (int dl = -reach; dl <= reach; ++dl) {
          const bool there =
              c + dc >= 0 && c + dc < lattice.columns && l + dl >= 0 && l + dl < lattice.layers;
          if (!there || weight(dc, dl) <= 0) continue;
          const Eigen::Vector2d r(dc * d, dl * d);
          bonds.neighbour.push_back(lattice.index(c + dc, l + dl));
          r0.push_back(r);
          w.push_back(weight(dc, dl));
          shape += w.back() * r * r.transpose();
        }
      }
      bonds.start.push_back(static_cast<Eigen::Index>(bonds.neighbour.size()));
      bonds.second_moment[i] = shape.trace();
      Eigen::Map<Eigen::Matrix2d>(bonds.shape_inverse.col(i).data()) = shape.inverse();
    }
  }
  const Eigen::Index m = static_cast<Eigen::Index>(w.size());
  bonds.r0.resize(2, m);
  for (Eigen::Index b = 0; b < m; ++b) bonds.r0.col(b) = r0[static_cast<std::size_t>(b)];
  bonds.weight = Eigen::Map<const Eigen::VectorXd>(w.data(), m);
  return bonds;
}

Eigen::Matrix4Xd displacement_gradient(const Bonds& bonds, const Eigen::Matrix2Xd& u) {
  const Eigen::Index n = bonds.size();
  Eigen::Matrix4Xd H(4, n);
#pragma omp parallel for schedule(static) if (n >= parallel_from)
  for (Eigen::Index i = 0; i < n; ++i) {
    double sxx = 0, syx = 0, sxy = 0, syy = 0;  // Σ w⁰ (u_j − u_i)⊗r⁰_ij
    const double ux = u(0, i), uy = u(1, i);
    for (Eigen::Index b = bonds.start[static_cast<std::size_t>(i)];
         b < bonds.start[static_cast<std::size_t>(i) + 1]; ++b) {
      const Eigen::Index j = bonds.neighbour[static_cast<std::size_t>(b)];
      const double wx = bonds.weight[b] * bonds.r0(0, b), wy = bonds.weight[b] * bonds.r0(1, b);
      const double dx = u(0, j) - ux, dy = u(1, j) - uy;
      sxx += dx * wx;
      syx += dy * wx;
      sxy += dx * wy;
      syy += dy * wy;
    }
    const auto A = bonds.shape_inverse.col(i);
    H(0, i) = sxx * A[0] + sxy * A[1];
    H(1, i) = syx * A[0] + syy * A[1];
    H(2, i) = sxx * A[2] + sxy * A[3];
    H(3, i) = syx * A[2] + syy * A[3];
  }
  return H;
}

}  // namespace strake::structure
