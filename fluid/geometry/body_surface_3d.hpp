#pragma once

#include "fluid/geometry/halved_edges.hpp"
#include "fluid/geometry/surface_patches.hpp"
#include "fluid/geometry/triangle_grid.hpp"
#include "fluid/geometry/wet_points.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace strake::fluid {

/// The wetted surface of bodies in space. It corresponds to `BodySurface2d` in the plane: smooth patches
/// between edges, with one wet point to about every l0². The motion is given on the points of the partner's
/// triangles. Wet points lie in those triangles and follow them. A rigid motion is therefore followed
/// exactly, and a deformation as the triangles describe it. What acts on a wet point goes to the corners of
/// its triangle; the sums of forces and moments are kept.
class BodySurface3d {
 public:
  using Vector3 = Eigen::Vector3d;

  /// A layer particle lies `depth` behind a point of its triangle's plane, along the normal of its wet point.
  /// `weight` gives that point by the triangle's corners. Weights below 0 are past the border of the patch.
  struct LayerParticle {
    int point = 0, triangle = 0;
    Vector3 weight = Vector3::Zero();
    double depth = 0;  // [m]
  };

  BodySurface3d() = default;
  /// partner: a closed surface of triangles. reach: largest radius of the scheme [m]. Throws Error(case_file)
  /// where the surface is not closed or inside out.
  BodySurface3d(const InterfaceMesh& partner, double spacing, double reach, const Knuckles& = {});

  bool empty() const { return points_.point.empty(); }
  const InterfaceMesh& mesh() const { return mesh_; }  // the partner's
  const Points& mesh_points() const { return now_; }   // its points in their places now
  int points() const { return static_cast<int>(points_.point.size()); }
  int edge_of(int k) const { return points_.point[static_cast<std::size_t>(k)].patch; }
  int triangle_of(int k) const { return points_.point[static_cast<std::size_t>(k)].triangle; }
  Vector3 face_normal(int triangle) const { return face_normal_.col(triangle); }
  /// Returns the particles behind each wet point, layer after layer. Then follow those past borders with an
  /// interior angle above 90°.
  const std::vector<LayerParticle>& layer_particles() const { return layer_particles_; }

  /// Sets displacement and velocity of the mesh's points, 3×n. places = false: velocities alone.
  void move(const Points& displacement, const Points& velocity, bool places);

  Vector3 reference(int k) const { return at(mesh_.position, k); }
  Vector3 point(int k) const { return point_.col(k); }
  Vector3 velocity(int k) const { return velocity_.col(k); }
  Vector3 normal(int k) const { return normal_.col(k); }
  Vector3 normal_rate(int k) const { return normal_rate_.col(k); }  // dn/dt [1/s]
  Vector3 area_vector(int k) const { return area_.col(k); }         // into the fluid [m²]; they sum to zero
  double area(int k) const { return area_.col(k).norm(); }
  Vector3 place(const LayerParticle&) const;
  Vector3 velocity(const LayerParticle&) const;
  Vector3 low() const { return grid_.low(); }  // bounding box
  Vector3 high() const { return grid_.high(); }

  /// The nearest place of the surface within `limit` [m].
  TriangleGrid::Foot near(const Vector3& x, double limit) const { return grid_.nearest(x, limit); }
  /// Whether the segment from a in the water to the layer particle b crosses the patch of wet point k. b
  /// belongs to that wet point, and `near` is the triangle nearest to a. A border counts for one of its
  /// patches.
  bool crosses(int k, int near, const Vector3& a, const Vector3& b) const;
  /// Whether the body lies between two places of water. near_a, near_b: their nearest triangles (−1: none
  /// within reach).
  bool separates(const Vector3& a, int near_a, const Vector3& b, int near_b) const;
  /// Returns the way between two such places of water that the body separates, around the edge between their
  /// nearest patches [m]. Around other edges than keels and blunt ones, and out of reach, there is none:
  /// infinity.
  double way_around(const Vector3& a, int near_a, const Vector3& b, int near_b) const;
  /// Whether such an edge lies within that distance of x.
  bool beside_corner(const Vector3& x, double distance) const { return halved_edges_.is_near(x, distance); }
  /// Whether x lies over the patch of wet point k: not past its edges. A keel and an edge of more than a
  /// right angle are passed at the plane that halves them.
  bool faces(int k, const Vector3& x) const;
  /// Returns the distance of x from the nearest edge of that patch, along the face [m]. It is negative past
  /// the edge, and infinite where no edge is near or x is past an edge that does not count.
  /// `counts(sharp, place)` says which edges count. sharp: water leaves the body there (`is_sharp_corner`).
  template <class Counts>
  double within(int k, const Vector3& x, const Counts& counts) const;
  double within(int k, const Vector3& x) const {
    return within(k, x, [](bool, const Vector3&) { return true; });
  }
  /// Returns how far x lies inside the nearest edge that is a keel of at most a right angle, along the face
  /// [m]. It is negative past it, and infinite where none is near.
  double inside_keel(int k, const Vector3& x) const;
  /// Returns the distance of x inside the plane that halves the chine nearest to it (`Bend::chine`), along
  /// the face of wet point k [m]. It is negative past it, and infinite where none is near.
  double inside_chine(int k, const Vector3& x) const;
  /// Whether the patch of wet point k lies in one plane at the start and has such corners alone.
  bool is_between_sharp_corners(int k) const {
    return patches_.between_sharp_corners[static_cast<std::size_t>(edge_of(k))] != 0;
  }
  /// Whether the patch of wet point k lies in no plane at the start.
  bool is_curved(int k) const { return patches_.curved[static_cast<std::size_t>(edge_of(k))] != 0; }
  bool inside(const Vector3& x) const { return grid_.inside(x); }

  struct Foot {
    int point = -1;  // a wet point of the nearest triangle
    Vector3 position = Vector3::Zero();
    double distance = 0;
  };
  Foot nearest(const Vector3& x) const;

  /// Sums values on the wet points, 3×points, on the mesh's points.
  Points spread(const Points& on_wet_points) const;
  /// Returns the value at wet point k of a field on the mesh's points.
  Vector3 at(const Points& on_mesh, int k) const;

 private:
  struct LocalEdge {  // of a patch, from a wet point near it, in the two edges of its triangle
    Eigen::Vector2d from, to;
    bool owned, sharp;
    double lean;       // tan of the angle between normal and halving plane, zero at a sharp or concave edge
    int mine, theirs;  // the triangles beside a chine, or an edge that ends in a smooth patch; else -1
  };
  bool is_on_side(const SurfacePatches::Border&, const Vector3& n) const;
  LocalEdge local_edge(const SurfacePatches::Border&, int k) const;
  /// Edges near each wet point, those of one after those of another.
  struct NearEdges {
    std::vector<std::size_t> start;  // of each wet point
    std::vector<LocalEdge> edge;
  };
  NearEdges near_edges(const std::vector<SurfacePatches::Border>&) const;
  /// Calls visit(edge, distance of x from it along the face [m], nearest place of the edge) for those of
  /// wet point k.
  template <class Visit>
  void for_each_near_edge(const NearEdges&, int k, const Vector3& x, const Visit& visit) const;
  void add_layers();
  void go_beyond();
  void add_beyond(const std::vector<const SurfacePatches::Border*>& chain);
  void bend(bool places);
  Vector3 corner(int triangle, int k) const { return now_.col(mesh_.faces(k, triangle)); }
  Eigen::Vector2d in_triangle(const Points& place, int triangle, const Vector3& arm) const;
  bool holds(int k, const Vector3& c) const;
  bool is_beyond_fading_edge(int k, const Vector3& x) const;
  bool in_front(int k, int near, const Vector3& a) const;
  Vector3 mean_of(const Points& values, int triangle, const Vector3& weight) const;

  InterfaceMesh mesh_;
  SurfacePatches patches_;
  WetPoints points_;
  HalvedEdges halved_edges_;
  double spacing_ = 0, reach_ = 0;
  std::vector<LayerParticle> layer_particles_;
  std::vector<int> point_in_;           // a wet point of each triangle
  NearEdges near_edges_;                // of the patch
  NearEdges near_chines_;               // within the patch
  Eigen::VectorXd patch_corner_scale_;  // 1/|Σ area vectors| at each corner, of the reference [1/m²]
  Points now_, rate_;                   // of the mesh's points
  Points point_, velocity_, normal_, normal_rate_, area_;
  Points face_normal_;  // of the triangles
  TriangleGrid grid_;
};

template <class Visit>
void BodySurface3d::for_each_near_edge(const NearEdges& edges, int k, const Vector3& x,
                                       const Visit& visit) const {
  const int t = points_.point[static_cast<std::size_t>(k)].triangle;
  const Vector3 e1 = corner(t, 1) - corner(t, 0), e2 = corner(t, 2) - corner(t, 0), middle = point_.col(k);
  const auto in_space = [&](const Eigen::Vector2d& at) -> Vector3 { return at.x() * e1 + at.y() * e2; };
  const Vector3 foot = in_space(in_triangle(now_, t, x - middle));
  const auto at = static_cast<std::size_t>(k);
  for (auto e = edges.start[at]; e < edges.start[at + 1]; ++e) {
    const LocalEdge& edge = edges.edge[e];
    const Vector3 from = in_space(edge.from), along = in_space(edge.to) - from;
    const Vector3 place = from + std::clamp((foot - from).dot(along) / along.squaredNorm(), 0.0, 1.0) * along;
    visit(edge, (foot - place).norm(), middle + place);
  }
}

template <class Counts>
double BodySurface3d::within(int k, const Vector3& x, const Counts& counts) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double nearest = infinity, counted = infinity;
  for_each_near_edge(near_edges_, k, x, [&](const LocalEdge& edge, double away, const Vector3& place) {
    nearest = std::min(nearest, away);
    if (away < counted && counts(edge.sharp, place)) counted = away;
  });
  if (holds(k, x)) return counted;
  return counted <= nearest ? -counted : infinity;
}

}  // namespace strake::fluid
