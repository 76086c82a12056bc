#include "structure/body/solid_surface.hpp"

#include "structure/body/triangulation.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

namespace strake::structure {

InterfaceMesh closed_surface(const std::vector<Eigen::Vector3d>& point,
                             const std::vector<std::array<int, 3>>& face) {
  InterfaceMesh mesh;
  mesh.name = "structure";
  mesh.dimension = 3;
  mesh.position.resize(3, static_cast<Eigen::Index>(point.size()));
  mesh.faces.resize(3, static_cast<Eigen::Index>(face.size()));
  for (std::size_t i = 0; i < point.size(); ++i) mesh.position.col(static_cast<Eigen::Index>(i)) = point[i];
  for (std::size_t f = 0; f < face.size(); ++f)
    mesh.faces.col(static_cast<Eigen::Index>(f)) << face[f][0], face[f][1], face[f][2];
  return mesh;
}

InterfaceMesh prism_surface(const InterfaceMesh& outline, double depth, double middle, double spacing) {
  const int n = static_cast<int>(outline.position.cols());
  const int strips = std::max(1, static_cast<int>(std::lround(depth / spacing)));
  std::vector<Eigen::Vector2d> ring;
  for (int i = 0; i < n; ++i) ring.emplace_back(outline.position.col(i).head<2>());
  std::vector<Eigen::Vector3d> point;
  std::vector<std::array<int, 3>> face;
  for (int k = 0; k <= strips; ++k) {
    const double z = middle + depth * (static_cast<double>(k) / strips - 0.5);
    for (const Eigen::Vector2d& x : ring) point.emplace_back(x.x(), x.y(), z);
  }
  // The diagonals turn about in neighbouring fields, so that none of both directions is preferred.
  for (int k = 0; k < strips; ++k)
    for (int i = 0; i < n; ++i) {
      const int a = k * n + i, b = k * n + (i + 1) % n, c = b + n, d = a + n;
      if ((i + k) % 2 == 0) {
        face.push_back({a, b, c});
        face.push_back({a, c, d});
      } else {
        face.push_back({a, b, d});
        face.push_back({b, c, d});
      }
    }
  // The end faces: the outline's own points, and new ones inside.
  const Triangulation end = triangulate(ring, spacing);
  for (const bool far : {false, true}) {
    const int first = far ? strips * n : 0, inner = static_cast<int>(point.size()) - n;
    const double z = middle + (far ? 0.5 : -0.5) * depth;
    for (std::size_t i = ring.size(); i < end.point.size(); ++i)
      point.emplace_back(end.point[i].x(), end.point[i].y(), z);
    const auto index = [&](int i) { return i < n ? first + i : inner + i; };
    for (const auto& [a, b, c] : end.triangle) {
      if (far)
        face.push_back({index(a), index(b), index(c)});
      else
        face.push_back({index(a), index(c), index(b)});
    }
  }
  return closed_surface(point, face);
}

InterfaceMesh sphere_surface(const Eigen::Vector3d& centre, double radius, double spacing) {
  // Corners of the icosahedron: the cyclic permutations of (0, ±1, ±φ). Neighbours are 2 apart.
  const double golden = std::numbers::phi;
  std::vector<Eigen::Vector3d> corner;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-golden, golden}) {
      corner.emplace_back(0, a, b);
      corner.emplace_back(a, b, 0);
      corner.emplace_back(b, 0, a);
    }
  std::vector<std::array<int, 3>> base;
  const auto beside = [&](int i, int j) {
    return (corner[static_cast<std::size_t>(i)] - corner[static_cast<std::size_t>(j)]).norm() < 2.1;
  };
  for (int i = 0; i < 12; ++i)
    for (int j = i + 1; j < 12; ++j)
      for (int k = j + 1; k < 12; ++k) {
        if (!beside(i, j) || !beside(j, k) || !beside(i, k)) continue;
        const Eigen::Vector3d &a = corner[static_cast<std::size_t>(i)],
                              &b = corner[static_cast<std::size_t>(j)],
                              &c = corner[static_cast<std::size_t>(k)];
        base.push_back(a.dot(b.cross(c)) > 0 ? std::array<int, 3>{i, j, k} : std::array<int, 3>{i, k, j});
      }

  const double edge = 2 / std::sqrt(1 + golden * golden) * radius;  // of the icosahedron in the sphere
  const int parts = std::max(1, static_cast<int>(std::ceil(edge / spacing)));
  std::vector<Eigen::Vector3d> point;
  std::vector<std::array<int, 3>> face;
  // A point is known by the weights of the corners that it lies between, so that faces share it.
  std::map<std::array<int, 6>, int> known;
  const auto index = [&](const std::array<int, 3>& tip, int u, int v) {
    const std::array<int, 3> weight = {parts - u - v, u, v};
    std::vector<std::pair<int, int>> used;
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      if (weight[k] == 0) continue;
      used.emplace_back(tip[k], weight[k]);
    }
    std::sort(used.begin(), used.end());
    std::array<int, 6> name{-1, -1, -1, -1, -1, -1};
    for (std::size_t k = 0; k < used.size(); ++k) {
      name[2 * k] = used[k].first;
      name[2 * k + 1] = used[k].second;
      x += used[k].second * corner[static_cast<std::size_t>(used[k].first)];
    }
    const auto [place, is_new] = known.emplace(name, static_cast<int>(point.size()));
    if (is_new) point.push_back(x.normalized());
    return place->second;
  };
  for (const auto& tip : base)
    for (int u = 0; u < parts; ++u)
      for (int v = 0; u + v < parts; ++v) {
        face.push_back({index(tip, u, v), index(tip, u + 1, v), index(tip, u, v + 1)});
        if (u + v + 1 < parts)
          face.push_back({index(tip, u + 1, v), index(tip, u + 1, v + 1), index(tip, u, v + 1)});
      }
  double volume = 0;  // of the unit sphere's polyhedron
  for (const auto& [a, b, c] : face)
    volume += point[static_cast<std::size_t>(a)].dot(
                  point[static_cast<std::size_t>(b)].cross(point[static_cast<std::size_t>(c)])) /
              6;
  const double outer = radius * std::cbrt(4.0 / 3.0 * std::numbers::pi / volume);
  for (Eigen::Vector3d& x : point) x = centre + outer * x;
  return closed_surface(point, face);
}

}  // namespace strake::structure
