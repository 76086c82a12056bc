#pragma once

#include "structure/fem/element/assembly.hpp"
#include "structure/fem/linear/linear_solver.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace strake::structure::fem {

/// Error in L2 of linear elasticity in a unit square clamped all around. u = (cos πx sin 2πy, cos πx sin πy)
/// with F = −(λ+μ) ∇(∇·u) − μ ∇²u. The 32 cells along x stay; 2^refinement along y set the error.
inline double error_of_smooth_solution(int degree, int refinement) {
  using std::numbers::pi;
  const Material material{.model = MaterialModel::linear, .density = 1, .young = 1, .poisson = 0.3};
  SolidBox square;
  square.name = "square";
  square.min << -0.5, 0, 0;
  square.max << 0.5, 1, 0;
  square.material = material;
  const Solid solid = solid_of_boxes(2, {square});
  const Discretisation<2> d(solid, degree, refinement);
  const Mesh<2>& mesh = d.mesh();
  const auto exact = [](const Eigen::Vector2d& x) {
    return Eigen::Vector2d(std::cos(pi * x.x()) * std::sin(2 * pi * x.y()),
                           std::cos(pi * x.x()) * std::sin(pi * x.y()));
  };
  const auto body_force = [&](const Eigen::Vector2d& x) -> Eigen::Vector2d {
    const double sx = std::sin(pi * x.x()), cx = std::cos(pi * x.x()), sy = std::sin(pi * x.y()),
                 cy = std::cos(pi * x.y());
    const Eigen::Vector2d gradient_of_divergence(-cx * std::sin(2 * pi * x.y()) - sx * cy,
                                                 -2 * sx * std::cos(2 * pi * x.y()) - cx * sy);
    const Eigen::Vector2d u = exact(x), laplacian(-5 * u.x(), -2 * u.y());
    return -pi * pi *
           ((material.lame_lambda() + material.lame_mu()) * gradient_of_divergence +
            material.lame_mu() * laplacian);
  };
  const auto each_point = [&](const auto& visit) {
    for (int c = 0; c < mesh.n_cells(); ++c)
      for (int q = 0; q < mesh.n_quadrature; ++q) {
        Eigen::Vector2d x = Eigen::Vector2d::Zero();
        for (Eigen::Index a = 0; a < mesh.cell.rows(); ++a)
          x += mesh.shape(a, q) * mesh.node.col(mesh.cell(a, c));
        visit(c, q, x, mesh.weight(c * mesh.n_quadrature + q));
      }
  };
  Eigen::VectorXd force = Eigen::VectorXd::Zero(mesh.n_unknowns());
  each_point([&](int c, int q, const Eigen::Vector2d& x, double weight) {
    for (Eigen::Index a = 0; a < mesh.cell.rows(); ++a)
      force.segment<2>(2 * mesh.cell(a, c)) += weight * mesh.shape(a, q) * body_force(x);
  });
  std::vector<int> fixed;
  for (int i = 0; i < mesh.n_nodes(); ++i)
    if (std::abs(mesh.node(0, i)) > 0.5 - 1e-9 || std::abs(mesh.node(1, i) - 0.5) > 0.5 - 1e-9)
      fixed.insert(fixed.end(), {2 * i, 2 * i + 1});
  LinearSolver solver;
  if (!solver.factorise(Assembly<2>(mesh, solid.parts).tangent(0 * force), fixed))
    return std::numeric_limits<double>::quiet_NaN();
  const Eigen::VectorXd u = solver.solve(force);
  double error = 0;
  each_point([&](int c, int q, const Eigen::Vector2d& x, double weight) {
    Eigen::Vector2d value = Eigen::Vector2d::Zero();
    for (Eigen::Index a = 0; a < mesh.cell.rows(); ++a)
      value += mesh.shape(a, q) * u.segment<2>(2 * mesh.cell(a, c));
    error += weight * (value - exact(x)).squaredNorm();
  });
  return std::sqrt(error);
}

}  // namespace strake::structure::fem
