#include "fluid/geometry/surface_patches.hpp"

#include "proto/error.hpp"
#include "proto/geometry/corner.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

namespace strake::fluid {

namespace {

using Vector3 = Eigen::Vector3d;

class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int i) {
    while (parent_[static_cast<std::size_t>(i)] != i) {
      int& up = parent_[static_cast<std::size_t>(i)];
      up = parent_[static_cast<std::size_t>(up)];
      i = up;
    }
    return i;
  }
  void join(int i, int j) {
    i = root(i);
    j = root(j);
    parent_[static_cast<std::size_t>(std::max(i, j))] = std::min(i, j);
  }

 private:
  std::vector<int> parent_;
};

struct Edge {
  int from = 0, to = 0;       // in the order of the triangle `left`
  int left = -1, right = -1;  // the two triangles
  double turn = 0;            // of the normal across it [rad], positive where the body is convex
  Bend bend = Bend::smooth;
  bool corner = false;  // the faces beside it end there
};

[[noreturn]] void fail(const InterfaceMesh& mesh, const std::string& problem, const std::string& fix) {
  throw Error(ExitCode::case_file, fmt::format("interface \"{}\"", mesh.name), problem, fix);
}

std::vector<Edge> edges_of(const InterfaceMesh& mesh) {
  std::map<std::pair<int, int>, int> known;  // by the pair in its triangle's order
  std::vector<Edge> edges;
  const auto n = static_cast<int>(mesh.position.cols());
  for (int t = 0; t < static_cast<int>(mesh.faces.cols()); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.faces(k, t), b = mesh.faces((k + 1) % 3, t);
      if (a < 0 || b < 0 || a >= n || b >= n || a == b)
        fail(mesh, fmt::format("face {} names points {} and {} of {}", t, a, b, n), "repair the mesh");
      if (known.contains({a, b}))
        fail(mesh, fmt::format("more than two faces meet in the edge from point {} to {}", a, b),
             "give a closed surface, every triangle counter-clockwise seen from the fluid");
      if (const auto back = known.find({b, a}); back != known.end()) {
        edges[static_cast<std::size_t>(back->second)].right = t;
        known[{a, b}] = back->second;
        continue;
      }
      known[{a, b}] = static_cast<int>(edges.size());
      edges.push_back({a, b, t});
    }
  for (const Edge& edge : edges)
    if (edge.right < 0)
      fail(mesh, fmt::format("the wet surface ends at the edge from point {} to {}", edge.from, edge.to),
           "the fluid needs to know inside from outside: close the surface");
  return edges;
}

/// Area vectors of the triangles [m²]. Refuses a triangle without area and a surface turned inside out.
std::vector<Vector3> areas_of(const InterfaceMesh& mesh) {
  const auto triangles = static_cast<std::size_t>(mesh.faces.cols());
  std::vector<Vector3> area(triangles);
  double volume = 0;
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto f = static_cast<Eigen::Index>(t);
    const Vector3 a = mesh.position.col(mesh.faces(0, f)), b = mesh.position.col(mesh.faces(1, f)),
                  c = mesh.position.col(mesh.faces(2, f));
    area[t] = 0.5 * (b - a).cross(c - a);
    volume += (a - mesh.position.col(0)).dot(area[t]) / 3;
    if (!(area[t].norm() > 0))
      fail(mesh, fmt::format("the points of face {} lie on one line", t), "repair the mesh");
  }
  if (!(volume > 0))
    fail(mesh, fmt::format("the surface encloses {} m^3", volume),
         "turn its triangles around, so that their normals point into the fluid");
  return area;
}

/// edge.turn: angle between the normals of both triangles, positive where the surface is convex [rad].
void measure_turns(const InterfaceMesh& mesh, const std::vector<Vector3>& area, std::vector<Edge>& edges) {
  for (Edge& edge : edges) {
    const Vector3 one = area[static_cast<std::size_t>(edge.left)].normalized(),
                  two = area[static_cast<std::size_t>(edge.right)].normalized();
    const Vector3 along = (mesh.position.col(edge.to) - mesh.position.col(edge.from)).normalized();
    edge.turn = std::atan2(one.cross(two).dot(along), one.dot(two));
  }
}

/// Finds what each edge is.
void find_bends(std::vector<Edge>& edges, const std::vector<Vector3>& area, const Knuckles& knuckles) {
  const std::size_t triangles = area.size();
  // Edges between triangles of one plane join them to a flat face. Other edges below the corner angle are
  // bends.
  Sets flat(triangles);
  for (const Edge& edge : edges)
    if (std::abs(edge.turn) < flat_angle) flat.join(edge.left, edge.right);
  const auto bends = [](const Edge& edge) {
    const double size = std::abs(edge.turn);
    return size >= flat_angle && size <= corner_angle;
  };
  // Edges along one line between the same two faces are one bend. For each face the largest turn to each face
  // beside it is kept.
  std::map<int, std::map<int, double>> beside;  // face → the face beyond → turn
  for (const Edge& edge : edges) {
    if (!bends(edge)) continue;
    const int i = flat.root(edge.left), j = flat.root(edge.right);
    beside[i][j] = std::max(beside[i][j], std::abs(edge.turn));
    beside[j][i] = std::max(beside[j][i], std::abs(edge.turn));
  }
  for (Edge& edge : edges) {
    const int i = flat.root(edge.left), j = flat.root(edge.right);
    double other = 0;
    for (const auto& [face, turn] : beside[i])
      if (face != j) other = std::max(other, turn);
    for (const auto& [face, turn] : beside[j])
      if (face != i) other = std::max(other, turn);
    const auto normal = [&](int t) { return area[static_cast<std::size_t>(t)].normalized(); };
    edge.bend = bend_of(edge.turn, other, normal(edge.left), normal(edge.right), knuckles);
    edge.corner = edge.bend == Bend::corner;
  }
}

/// Numbers the sets of triangles that are joined over the edges that join, in the order of their first
/// triangles.
template <class Joins>
std::vector<int> numbered_sets(const std::vector<Edge>& edges, std::size_t triangles, const Joins& joins) {
  Sets sets(triangles);
  for (const Edge& edge : edges)
    if (joins(edge)) sets.join(edge.left, edge.right);
  std::vector<int> of_triangle(triangles);
  std::map<int, int> number;
  for (std::size_t t = 0; t < triangles; ++t)
    of_triangle[t] =
        number.emplace(sets.root(static_cast<int>(t)), static_cast<int>(number.size())).first->second;
  return of_triangle;
}

/// Numbers the corners of the triangles, in their order. Triangles that share a point and a smooth edge there
/// have one number.
Eigen::Matrix3Xi corners_between(const InterfaceMesh& mesh, const std::vector<Edge>& edges) {
  const auto place = [&](int triangle, int point) {
    int k = 0;
    while (mesh.faces(k, triangle) != point) ++k;
    return 3 * triangle + k;
  };
  Sets shared(static_cast<std::size_t>(mesh.faces.size()));
  for (const Edge& edge : edges)
    for (const int point : {edge.from, edge.to})
      if (!edge.corner && !is_turn_within_face(edge.bend))
        shared.join(place(edge.left, point), place(edge.right, point));
  Eigen::Matrix3Xi corner(3, mesh.faces.cols());
  int count = 0;
  for (int i = 0; i < static_cast<int>(corner.size()); ++i) {
    const int root = shared.root(i);  // the least
    corner.data()[i] = root == i ? count++ : corner.data()[root];
  }
  return corner;
}

/// Marks the curved patches, and the plane ones with sharp edges alone. A patch without an edge is the whole
/// of a closed surface, which is not plane.
void find_plane_patches(const std::vector<Vector3>& area, SurfacePatches& patches) {
  patches.curved.assign(patches.area.size(), 0);
  patches.between_sharp_corners.assign(patches.area.size(), 1);
  for (const auto& border : patches.border)
    if (!border.sharp) patches.between_sharp_corners[static_cast<std::size_t>(border.patch)] = 0;
  std::vector<int> first(patches.area.size(), -1);  // triangle of each patch
  for (std::size_t t = 0; t < area.size(); ++t) {
    const auto patch = static_cast<std::size_t>(patches.of_triangle[t]);
    if (first[patch] < 0) first[patch] = static_cast<int>(t);
    const Vector3 normal = area[static_cast<std::size_t>(first[patch])].normalized();
    if (area[t].normalized().cross(normal).norm() > flat_angle) patches.curved[patch] = 1;
    if (patches.curved[patch]) patches.between_sharp_corners[patch] = 0;
  }
}

}  // namespace

SurfacePatches find_patches(const InterfaceMesh& mesh, const Knuckles& knuckles) {
  if (mesh.faces.rows() != 3) fail(mesh, "its faces are no triangles", "give a closed surface of triangles");
  std::vector<Edge> edges = edges_of(mesh);
  const std::vector<Vector3> area = areas_of(mesh);
  const std::size_t triangles = area.size();
  measure_turns(mesh, area, edges);
  find_bends(edges, area, knuckles);

  SurfacePatches patches;
  patches.of_triangle = numbered_sets(edges, triangles, [](const Edge& edge) { return !edge.corner; });
  patches.part_of_triangle = numbered_sets(
      edges, triangles, [](const Edge& edge) { return !edge.corner && !is_turn_within_face(edge.bend); });
  patches.area.assign(1 + static_cast<std::size_t>(std::ranges::max(patches.of_triangle)), 0);
  for (std::size_t t = 0; t < triangles; ++t)
    patches.area[static_cast<std::size_t>(patches.of_triangle[t])] += area[t].norm();
  for (Edge& edge : edges) {
    if (!edge.corner && !is_turn_within_face(edge.bend)) continue;
    const int left = patches.of_triangle[static_cast<std::size_t>(edge.left)],
              right = patches.of_triangle[static_cast<std::size_t>(edge.right)];
    // A convex edge that fades out in a smooth surface has two sides as far as its turn is a corner's.
    const double angle = std::numbers::pi - edge.turn;
    edge.corner = edge.corner && (left != right || edge.turn > 0);
    if (!edge.corner && !is_turn_within_face(edge.bend)) continue;
    const auto down = [&](int t) { return -area[static_cast<std::size_t>(t)].normalized().y(); };
    const bool sharp = is_sharp_corner(angle, down(edge.left), down(edge.right));
    auto& sides = edge.corner ? patches.border : edge.bend == Bend::chine ? patches.chine : patches.knuckle;
    sides.push_back({left, edge.left, edge.from, edge.to, right, edge.right, angle, sharp});
    sides.push_back({right, edge.right, edge.to, edge.from, left, edge.left, angle, sharp});
  }
  find_plane_patches(area, patches);
  patches.corner = corners_between(mesh, edges);
  return patches;
}

}  // namespace strake::fluid
