#pragma once

#include "proto/interface.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>

namespace strake {

/// The underside of a plate, walked from left to right: n segments.
inline InterfaceMesh strip(const std::string& name, int n, double length, double y = 0) {
  InterfaceMesh mesh = {name, 2, Points::Zero(3, n + 1), Eigen::MatrixXi(2, n), {}};
  for (int i = 0; i <= n; ++i) mesh.position.col(i) = Eigen::Vector3d(length * i / n, y, 0);
  for (int i = 0; i < n; ++i) mesh.faces.col(i) = Eigen::Vector2i(i, i + 1);
  return mesh;
}

/// 2 m² triangles over the unit square of (a, b), each of its (m + 1)² points where `place` puts it.
inline InterfaceMesh patchwork(const std::string& name, int m,
                               const std::function<Eigen::Vector3d(double, double)>& place) {
  InterfaceMesh mesh = {name, 3, Points::Zero(3, (m + 1) * (m + 1)), Eigen::MatrixXi(3, 2 * m * m), {}};
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= m; ++i) mesh.position.col(j * (m + 1) + i) = place(1.0 * i / m, 1.0 * j / m);
  Eigen::Index f = 0;
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < m; ++i) {
      const int a = j * (m + 1) + i;
      mesh.faces.col(f++) = Eigen::Vector3i(a, a + 1, a + m + 2);
      mesh.faces.col(f++) = Eigen::Vector3i(a, a + m + 2, a + m + 1);
    }
  return mesh;
}

/// A rectangle in the plane z = x/2.
inline InterfaceMesh sheet(int m) {
  return patchwork("sheet", m, [](double a, double b) { return Eigen::Vector3d(a, 2 * b, 0.5 * a); });
}

/// z = 0.1 sin 2πx cos 2πy over the unit square, spacing h = 1/m. The points are moved by `shift` · h along x
/// and y, so that the meshes of two solvers do not match.
inline InterfaceMesh wavy(int m, double shift = 0) {
  return patchwork(shift == 0 ? "structure" : "fluid", m, [&](double a, double b) {
    const double x = a + shift / m, y = b + shift / m, turn = 2 * std::numbers::pi;
    return Eigen::Vector3d(x, y, 0.1 * std::sin(turn * x) * std::cos(turn * y));
  });
}

inline InterfaceMesh scattered(const InterfaceMesh& like, int n,
                               const std::function<Eigen::Vector3d(double, double)>& place) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  InterfaceMesh mesh = {"fluid", like.dimension, Points(3, n), {}, {}};
  for (int i = 0; i < n; ++i) {
    const double a = unit(random), b = unit(random);
    mesh.position.col(i) = place(a, b);
  }
  return mesh;
}

inline Eigen::MatrixXd random_values(Eigen::Index n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(3, n, [&] { return normal(random); });
}

inline double dot(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.reshaped().dot(b.reshaped());
}

/// A field linear in space.
inline Eigen::MatrixXd linear(const Points& x) {
  Eigen::Matrix3d gradient;
  gradient << 1, 2, -1, 0.5, 0, 3, -2, 1, 1;
  return gradient * x;
}

}  // namespace strake
