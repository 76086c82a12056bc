#include "coupler/coupling/assembly.hpp"
#include "proto/geometry/triangle.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// The points and faces of one body of the mesh.
struct Part {
  const MeshPart* mesh;
  Index end_point, end_face;
  Eigen::AlignedBox3d box;
};

std::vector<Part> parts_of(const InterfaceMesh& mesh, const Points& position) {
  std::vector<Part> parts;
  for (std::size_t k = 0; k < mesh.parts.size(); ++k) {
    const bool last = k + 1 == mesh.parts.size();
    Part part{&mesh.parts[k],
              last ? position.cols() : mesh.parts[k + 1].first_point,
              last ? mesh.faces.cols() : mesh.parts[k + 1].first_face,
              {}};
    for (Index i = part.mesh->first_point; i < part.end_point; ++i) part.box.extend(position.col(i));
    parts.push_back(part);
  }
  return parts;
}

/// Distance from x to a face of the mesh, a segment or a triangle [m].
double distance_to_face(const InterfaceMesh& mesh, const Points& position, Index face, const Vector3d& x) {
  const Vector3d a = position.col(mesh.faces(0, face)), b = position.col(mesh.faces(1, face));
  if (mesh.faces.rows() == 2) return distance_to_segment(a, b, x);
  Eigen::Matrix3d corner;
  corner << a, b, position.col(mesh.faces(2, face));
  return (corner * nearest_in_triangle(corner, x) - x).norm();
}

/// The part of the full angle under which a face is seen from x: turn/2π of a segment, Ω/4π of a triangle
/// with
///   tan(Ω/2) = a·(b × c) / (|a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b|)
/// (Van Oosterom & Strackee 1983). Over a closed surface the sum is 1 inside and 0 outside.
double seen_part(const InterfaceMesh& mesh, const Points& position, Index face, const Vector3d& x) {
  const Vector3d a = position.col(mesh.faces(0, face)) - x, b = position.col(mesh.faces(1, face)) - x;
  if (mesh.faces.rows() == 2)
    return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)) / (2 * std::numbers::pi);
  const Vector3d c = position.col(mesh.faces(2, face)) - x;
  const double na = a.norm(), nb = b.norm(), nc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), na * nb * nc + a.dot(b) * nc + b.dot(c) * na + c.dot(a) * nb) /
         (4 * std::numbers::pi);
}

}  // namespace

std::optional<BodyGap> closest_bodies(const InterfaceMesh& mesh, const Points& displacement, double limit) {
  const Points position = mesh.position + displacement;
  const std::vector<Part> parts = parts_of(mesh, position);
  std::optional<BodyGap> closest;
  for (const Part& one : parts)
    for (const Part& other : parts) {
      if (&one == &other || one.box.exteriorDistance(other.box) >= limit) continue;
      for (Index i = one.mesh->first_point; i < one.end_point; ++i) {
        const Vector3d x = position.col(i);
        if (other.box.exteriorDistance(x) >= limit) continue;
        for (Index f = other.mesh->first_face; f < other.end_face; ++f) {
          const double distance = distance_to_face(mesh, position, f, x);
          if (distance < (closest ? closest->distance : limit))
            closest = BodyGap{one.mesh->name, other.mesh->name, distance, x, false};
        }
      }
    }
  return closest;
}

std::optional<BodyGap> body_inside_another(const InterfaceMesh& mesh, const Points& displacement) {
  const Points position = mesh.position + displacement;
  const std::vector<Part> parts = parts_of(mesh, position);
  for (const Part& one : parts)
    for (const Part& other : parts) {
      if (&one == &other) continue;
      for (Index i = one.mesh->first_point; i < one.end_point; ++i) {
        const Vector3d x = position.col(i);
        if (!other.box.contains(x)) continue;
        double part = 0, distance = other.box.diagonal().norm();
        for (Index f = other.mesh->first_face; f < other.end_face; ++f) {
          part += seen_part(mesh, position, f, x);
          distance = std::min(distance, distance_to_face(mesh, position, f, x));
        }
        constexpr double touching = 1e-6;  // of the other body's size
        if (distance < touching * other.box.diagonal().norm()) continue;
        if (std::abs(part) > 0.5) return BodyGap{one.mesh->name, other.mesh->name, 0, x, true};
      }
    }
  return std::nullopt;
}

}  // namespace strake
