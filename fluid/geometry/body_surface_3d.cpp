#include "fluid/geometry/body_surface_3d.hpp"

#include "proto/geometry/corner.hpp"
#include "proto/geometry/polygon.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace strake::fluid {

namespace {

using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;

/// Round-off allowance at an edge, as a share of the distance to it.
constexpr double tie = 1e-9;
/// Cosine of two triangles' normals, 25 degrees, above which no chine that ends in their patch lies between
/// them: it turns by 46 degrees and more. A keel that ends there and is blunter lengthens no pair.
constexpr double one_side = 0.9;

}  // namespace

BodySurface3d::BodySurface3d(const InterfaceMesh& partner, double spacing, double reach,
                             const Knuckles& knuckles)
    : mesh_(partner),
      patches_(find_patches(partner, knuckles)),
      points_(wet_points(partner, patches_, spacing)),
      halved_edges_(patches_),
      spacing_(spacing),
      reach_(reach) {
  mesh_.name = "fluid";
  const auto triangles = static_cast<std::size_t>(mesh_.faces.cols());
  point_in_.assign(triangles, -1);
  std::vector<double> largest(triangles, 0);
  for (const WetPoints::Share& share : points_.share) {
    const auto t = static_cast<std::size_t>(share.triangle);
    if (share.part <= largest[t]) continue;
    largest[t] = share.part;
    point_in_[t] = share.point;
  }
  const auto m = static_cast<Eigen::Index>(points());
  for (Points* p : {&point_, &velocity_, &normal_, &normal_rate_, &area_}) p->setZero(3, m);
  patch_corner_scale_.setOnes(patches_.corner.maxCoeff() + 1);
  const Points still = Points::Zero(3, mesh_.position.cols());
  now_ = mesh_.position;
  rate_ = still;
  Points sum = Points::Zero(3, patch_corner_scale_.size());
  for (int t = 0; t < static_cast<int>(triangles); ++t)
    for (int k = 0; k < 3; ++k)
      sum.col(patches_.corner(k, t)) +=
          0.5 * (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
  patch_corner_scale_ = sum.colwise().norm().cwiseInverse();
  move(still, still, true);
  near_edges_ = near_edges(patches_.border);
  near_chines_ = near_edges(patches_.chine);
  add_layers();
}

Vector3 BodySurface3d::mean_of(const Points& values, int t, const Vector3& weight) const {
  return weight[0] * values.col(mesh_.faces(0, t)) + weight[1] * values.col(mesh_.faces(1, t)) +
         weight[2] * values.col(mesh_.faces(2, t));
}

void BodySurface3d::move(const Points& displacement, const Points& velocity, bool places) {
  if (places) now_ = mesh_.position + displacement;
  rate_ = velocity;
  bend(places);
  if (!places) return;
  grid_.build(now_, mesh_.faces, 2 * spacing_);
  halved_edges_.build(now_, face_normal_, 2 * spacing_);
}

// Computes the normals n and dn/dt from the area vectors of the triangles:
//   S = ½ e₁ × e₂,   dS/dt = ½ (ė₁ × e₂ + e₁ × ė₂).
// At a corner of a patch m is the sum over its triangles, scaled by the reference. Between the corners m is
// interpolated. Then
//   n = m/|m|,   dn/dt = (ṁ − n n·ṁ)/|m|.
void BodySurface3d::bend(bool places) {
  const auto triangles = static_cast<int>(mesh_.faces.cols());
  Points sum = Points::Zero(3, patch_corner_scale_.size()), sum_rate = sum;
  Points area(3, triangles);
  if (places) face_normal_.resize(3, triangles);
  for (int t = 0; t < triangles; ++t) {
    const Vector3 e1 = corner(t, 1) - corner(t, 0), e2 = corner(t, 2) - corner(t, 0);
    const Vector3 v1 = rate_.col(mesh_.faces(1, t)) - rate_.col(mesh_.faces(0, t)),
                  v2 = rate_.col(mesh_.faces(2, t)) - rate_.col(mesh_.faces(0, t));
    area.col(t) = 0.5 * e1.cross(e2);
    const Vector3 rate = 0.5 * (v1.cross(e2) + e1.cross(v2));
    if (places) face_normal_.col(t) = area.col(t).normalized();
    for (int k = 0; k < 3; ++k) {
      sum.col(patches_.corner(k, t)) += area.col(t);
      sum_rate.col(patches_.corner(k, t)) += rate;
    }
  }
  for (int k = 0; k < points(); ++k) {
    const WetPoints::Point& p = points_.point[static_cast<std::size_t>(k)];
    Vector3 m = Vector3::Zero(), rate = Vector3::Zero();
    for (int c = 0; c < 3; ++c) {
      const int at = patches_.corner(c, p.triangle);
      m += p.weight[c] * patch_corner_scale_[at] * sum.col(at);
      rate += p.weight[c] * patch_corner_scale_[at] * sum_rate.col(at);
    }
    const double size = m.norm();
    const Vector3 n = m / size;
    normal_.col(k) = n;
    normal_rate_.col(k) = (rate - n * n.dot(rate)) / size;
    point_.col(k) = mean_of(now_, p.triangle, p.weight);
    velocity_.col(k) = mean_of(rate_, p.triangle, p.weight);
  }
  if (!places) return;
  area_.setZero();
  for (const WetPoints::Share& share : points_.share)
    area_.col(share.point) += share.part * area.col(share.triangle);
}

Vector2 BodySurface3d::in_triangle(const Points& place, int t, const Vector3& arm) const {
  const Vector3 e1 = place.col(mesh_.faces(1, t)) - place.col(mesh_.faces(0, t)),
                e2 = place.col(mesh_.faces(2, t)) - place.col(mesh_.faces(0, t));
  const double g11 = e1.dot(e1), g12 = e1.dot(e2), g22 = e2.dot(e2), d1 = arm.dot(e1), d2 = arm.dot(e2);
  const double determinant = g11 * g22 - g12 * g12;
  return {(g22 * d1 - g12 * d2) / determinant, (g11 * d2 - g12 * d1) / determinant};
}

// Whether a wet point with the normal n lies on this side of an edge that ends in a smooth patch: the normal
// of this side's triangle is nearer to n than the other's.
bool BodySurface3d::is_on_side(const SurfacePatches::Border& border, const Vector3& n) const {
  if (border.other != border.patch) return true;
  const double mine = n.dot(face_normal_.col(border.triangle)),
               theirs = n.dot(face_normal_.col(border.other_triangle));
  return mine > theirs || (mine == theirs && border.is_first());
}

// The larger of two patches owns the edge between them, of equal ones the first.
auto BodySurface3d::local_edge(const SurfacePatches::Border& border, int k) const -> LocalEdge {
  const int t = points_.point[static_cast<std::size_t>(k)].triangle;
  const Vector3 x = point_.col(k), a = mesh_.position.col(border.from), b = mesh_.position.col(border.to);
  const double mine = patches_.area[static_cast<std::size_t>(border.patch)],
               theirs = patches_.area[static_cast<std::size_t>(border.other)];
  const bool owned = mine > theirs * (1 + tie) || (mine > theirs * (1 - tie) && border.is_first());
  const bool divides = border.other != border.patch;
  return {in_triangle(mesh_.position, t, a - x),
          in_triangle(mesh_.position, t, b - x),
          owned,
          border.sharp,
          border.is_halved() ? 1 / std::tan(0.5 * border.angle) : 0.0,
          divides ? -1 : border.triangle,
          divides ? -1 : border.other_triangle};
}

auto BodySurface3d::near_edges(const std::vector<SurfacePatches::Border>& borders) const -> NearEdges {
  const double far = reach_ + 2 * spacing_;
  std::vector<std::vector<const SurfacePatches::Border*>> of_patch(patches_.area.size());
  for (const auto& border : borders) of_patch[static_cast<std::size_t>(border.patch)].push_back(&border);
  NearEdges near;
  near.start.assign(1, 0);
  for (int k = 0; k < points(); ++k) {
    const Vector3 x = point_.col(k);
    for (const auto* border : of_patch[static_cast<std::size_t>(edge_of(k))]) {
      const Vector3 a = mesh_.position.col(border->from), t = mesh_.position.col(border->to) - a;
      const double s = std::clamp((x - a).dot(t) / t.squaredNorm(), 0.0, 1.0);
      if ((a + s * t - x).norm() <= far && is_on_side(*border, normal_.col(k)))
        near.edge.push_back(local_edge(*border, k));
    }
    near.start.push_back(near.edge.size());
  }
  return near;
}

void BodySurface3d::add_layers() {
  const int layers = static_cast<int>(std::ceil(reach_ / spacing_ - 0.5));
  for (int layer = 0; layer < layers; ++layer)
    for (int k = 0; k < points(); ++k) {
      const WetPoints::Point& p = points_.point[static_cast<std::size_t>(k)];
      layer_particles_.push_back({k, p.triangle, p.weight, (layer + 0.5) * spacing_});
    }
  go_beyond();
}

// Joins the borders between the same two patches end to end, on either side of an edge that ends in a patch.
void BodySurface3d::go_beyond() {
  const auto at = [&](const SurfacePatches::Border& border, int mesh_point) {  // the corner of its triangle
    int k = 0;
    while (mesh_.faces(k, border.triangle) != mesh_point) ++k;
    return patches_.corner(k, border.triangle);
  };
  std::map<std::pair<int, int>, std::vector<const SurfacePatches::Border*>> groups;
  for (const auto& border : patches_.border) groups[{border.patch, border.other}].push_back(&border);
  for (const auto& [key, group] : groups) {
    std::map<int, const SurfacePatches::Border*> from, to;
    for (const auto* border : group) {
      from[at(*border, border->from)] = border;
      to[at(*border, border->to)] = border;
    }
    std::vector<const SurfacePatches::Border*> starts;
    for (const auto* border : group)
      if (!to.contains(at(*border, border->from))) starts.push_back(border);
    for (const auto* border : group) starts.push_back(border);  // closed rings start anywhere
    for (const auto* start : starts) {
      std::vector<const SurfacePatches::Border*> chain;
      for (auto next = from.find(at(*start, start->from)); next != from.end();
           next = from.find(at(*chain.back(), chain.back()->to))) {
        chain.push_back(next->second);
        from.erase(next);
      }
      if (!chain.empty()) add_beyond(chain);
    }
  }
}

// Layers continue past an edge of the angle α inside the body. Let θ be the angle of a place behind the face,
// measured from the face. Some pairs with water cross the face on their way to that place where θ < min(α,
// π). The layers behind the face itself reach θ = π/2. At depth d below the face and s beyond its edge
// tan(θ − π/2) = s/d.
void BodySurface3d::add_beyond(const std::vector<const SurfacePatches::Border*>& chain) {
  constexpr double round_off = 1e-6;  // [rad]
  std::vector<double> length{0};
  for (const auto* border : chain)
    length.push_back(length.back() +
                     (mesh_.position.col(border->to) - mesh_.position.col(border->from)).norm());
  const int count = std::max(1, static_cast<int>(std::lround(length.back() / spacing_)));
  const int columns = static_cast<int>(std::ceil(reach_ / spacing_));
  const int layers = static_cast<int>(std::ceil(reach_ / spacing_ - 0.5));
  for (int m = 0; m < count; ++m) {
    const double along = (m + 0.5) * length.back() / count;
    const auto e = static_cast<std::size_t>(std::upper_bound(length.begin() + 1, length.end() - 1, along) -
                                            length.begin() - 1);
    const SurfacePatches::Border& border = *chain[e];
    const double angle = std::min(border.angle, std::numbers::pi);
    if (angle < right_angle) continue;
    const bool concave = angle > std::numbers::pi - round_off;
    const double slope = concave ? 0.0 : 1 / std::tan(angle - 0.5 * std::numbers::pi);
    const Vector3 a = mesh_.position.col(border.from), b = mesh_.position.col(border.to);
    const Vector3 t = (b - a).normalized(), x = a + (along - length[e]) * t;
    const Vector3 out = t.cross(face_normal_.col(border.triangle));
    int nearest = -1;
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k < points(); ++k) {
      const double squared = (point(k) - x).squaredNorm();
      if (edge_of(k) != border.patch || squared >= best || !is_on_side(border, normal_.col(k))) continue;
      best = squared;
      nearest = k;
    }
    if (nearest < 0) continue;
    for (int column = 0; column < columns; ++column) {
      const double beside = (column + 0.5) * spacing_;
      const Vector2 share =
          in_triangle(mesh_.position, border.triangle,
                      x + beside * out - mesh_.position.col(mesh_.faces(0, border.triangle)));
      const Vector3 weight(1 - share.x() - share.y(), share.x(), share.y());
      for (int layer = 0; layer < layers; ++layer) {
        const double depth = (layer + 0.5) * spacing_;
        if (depth < slope * beside) continue;
        layer_particles_.push_back({nearest, border.triangle, weight, depth});
      }
    }
  }
}

Vector3 BodySurface3d::place(const LayerParticle& at) const {
  return mean_of(now_, at.triangle, at.weight) - at.depth * normal_.col(at.point);
}

Vector3 BodySurface3d::velocity(const LayerParticle& at) const {
  return mean_of(rate_, at.triangle, at.weight) - at.depth * normal_rate_.col(at.point);
}

// Whether c, in the plane of the patch at wet point k, lies on that patch. It does when the straight line
// from k to c crosses the edges of the patch an even number of times.
bool BodySurface3d::holds(int k, const Vector3& c) const {
  const auto first = near_edges_.start[static_cast<std::size_t>(k)],
             last = near_edges_.start[static_cast<std::size_t>(k) + 1];
  if (first == last) return true;
  const Vector2 way =
      in_triangle(now_, points_.point[static_cast<std::size_t>(k)].triangle, c - point_.col(k));
  bool in = true;
  for (std::size_t e = first; e < last; ++e) {
    const LocalEdge& edge = near_edges_.edge[e];
    const double sa = cross(way, edge.from), sb = cross(way, edge.to);
    if ((sa > 0) == (sb > 0)) continue;
    const Vector2 along = edge.to - edge.from;
    const double det = cross(way, along);
    if (det == 0) continue;
    const double s = cross(edge.from, along) / det;  // along the line to c
    if (s > 0 && s < (edge.owned ? 1 - tie : 1 + tie)) in = !in;
  }
  return in;
}

// Whether x lies beyond an edge that ends in the patch of wet point k: on the other side of the plane that
// halves the nearest such edge.
bool BodySurface3d::is_beyond_fading_edge(int k, const Vector3& x) const {
  double nearest = std::numeric_limits<double>::infinity();
  bool beyond = false;
  for_each_near_edge(near_edges_, k, x, [&](const LocalEdge& edge, double away, const Vector3& place) {
    if (edge.theirs < 0 || away >= nearest) return;
    nearest = away;
    beyond = (x - place).dot(face_normal_.col(edge.mine) - face_normal_.col(edge.theirs)) < 0;
  });
  return beyond;
}

// Whether a lies in front of the patch at wet point k. A curved patch bends away from its tangent plane, so
// water in front of the nearest triangle of the patch counts too, on this side of an edge that ends in it.
bool BodySurface3d::in_front(int k, int near, const Vector3& a) const {
  if ((a - point_.col(k)).dot(normal_.col(k)) > 0) return true;
  return near >= 0 && patches_.of_triangle[static_cast<std::size_t>(near)] == edge_of(k) &&
         face_normal_.col(near).dot(normal_.col(k)) > 0 &&
         (a - corner(near, 0)).dot(face_normal_.col(near)) > 0 && !is_beyond_fading_edge(k, a);
}

bool BodySurface3d::crosses(int k, int near, const Vector3& a, const Vector3& b) const {
  if (!in_front(k, near, a)) return false;
  const double ha = std::max(0.0, (a - point_.col(k)).dot(normal_.col(k))),
               hb = (point_.col(k) - b).dot(normal_.col(k));
  return holds(k, a + ha / (ha + hb) * (b - a));
}

bool BodySurface3d::separates(const Vector3& a, int near_a, const Vector3& b, int near_b) const {
  if (near_a < 0 || near_b < 0) return false;
  if (const int patch = patches_.of_triangle[static_cast<std::size_t>(near_a)];
      patch == patches_.of_triangle[static_cast<std::size_t>(near_b)]) {
    const double alike = face_normal_.col(near_a).dot(face_normal_.col(near_b));
    if (alike > one_side || (alike > 0 && !halved_edges_.divides(a, b, patch, reach_))) return false;
  }
  return grid_.cuts(a, b);
}

double BodySurface3d::way_around(const Vector3& a, int near_a, const Vector3& b, int near_b) const {
  const auto patch = [&](int t) { return patches_.of_triangle[static_cast<std::size_t>(t)]; };
  return halved_edges_.way_around(a, patch(near_a), b, patch(near_b), reach_);
}

// Water before a keel or a blunt edge lies past both faces, and must have one of them (F85). It
// has the nearer: at the height h over a face, the plane that halves the angle α lies h tan((π − α)/2) past
// the edge. The edge nearest to the foot of x counts; of two as near, where they meet, a sharp one.
bool BodySurface3d::faces(int k, const Vector3& x) const {
  if (holds(k, x)) return true;
  const Vector3 arm = x - point_.col(k);
  const double height = arm.dot(normal_.col(k));
  if (!(height > 0)) return false;
  double past = std::numeric_limits<double>::infinity(), allowed = 0;
  for_each_near_edge(near_edges_, k, x, [&](const LocalEdge& edge, double away, const Vector3&) {
    if (away > past * (1 + tie) || (away > past * (1 - tie) && edge.lean > 0)) return;
    past = away;
    allowed = height * edge.lean;
  });
  return past <= allowed;
}

double BodySurface3d::inside_keel(int k, const Vector3& x) const {
  double nearest = std::numeric_limits<double>::infinity();
  for_each_near_edge(near_edges_, k, x, [&](const LocalEdge& edge, double away, const Vector3&) {
    if (edge.lean > 1) nearest = std::min(nearest, away);
  });
  return std::isinf(nearest) || holds(k, x) ? nearest : -nearest;
}

// With the normals n of this side and n' of the other one, n − n' points across the plane that halves the
// chine:
//   e = (x − place)·(n − n')/|n × n'| .
double BodySurface3d::inside_chine(int k, const Vector3& x) const {
  double nearest = std::numeric_limits<double>::infinity(), inside = nearest;
  if (patches_.chine.empty()) return inside;
  for_each_near_edge(near_chines_, k, x, [&](const LocalEdge& edge, double away, const Vector3& place) {
    const Vector3 mine = face_normal_.col(edge.mine), theirs = face_normal_.col(edge.theirs);
    const double e = (x - place).dot(mine - theirs) / mine.cross(theirs).norm();
    if (away > nearest || (away == nearest && e > inside)) return;
    nearest = away;
    inside = e;
  });
  return inside;
}

auto BodySurface3d::nearest(const Vector3& x) const -> Foot {
  const TriangleGrid::Foot foot = grid_.nearest(x);
  return {point_in_[static_cast<std::size_t>(foot.triangle)], foot.position, foot.distance};
}

Points BodySurface3d::spread(const Points& on_wet_points) const {
  Points sum = Points::Zero(3, mesh_.position.cols());
  for (int k = 0; k < points(); ++k) {
    const WetPoints::Point& p = points_.point[static_cast<std::size_t>(k)];
    for (int c = 0; c < 3; ++c) sum.col(mesh_.faces(c, p.triangle)) += p.weight[c] * on_wet_points.col(k);
  }
  return sum;
}

Vector3 BodySurface3d::at(const Points& on_mesh, int k) const {
  const WetPoints::Point& p = points_.point[static_cast<std::size_t>(k)];
  return mean_of(on_mesh, p.triangle, p.weight);
}

}  // namespace strake::fluid
