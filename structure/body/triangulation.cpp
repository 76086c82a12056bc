#include "structure/body/triangulation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <utility>

namespace strake::structure {
namespace {

using Vector2 = Eigen::Vector2d;
using Triangle = std::array<int, 3>;
using Edge = std::pair<int, int>;  // directed: a triangle lies to its left

double doubled_area(const Vector2& a, const Vector2& b, const Vector2& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// The angle at the tip of an ear, or −1 if the corner is no ear. It is none if it is reflex, or if another
/// point lies in it.
double ear_angle(const std::vector<Vector2>& p, const std::vector<int>& left, std::size_t i) {
  const std::size_t n = left.size();
  const int a = left[(i + n - 1) % n], b = left[i], c = left[(i + 1) % n];
  const auto at = [&](int k) -> const Vector2& { return p[static_cast<std::size_t>(k)]; };
  const double size = (at(c) - at(a)).squaredNorm();
  if (doubled_area(at(a), at(b), at(c)) <= 1e-12 * size) return -1;
  for (const int k : left) {
    if (k == a || k == b || k == c) continue;
    if (doubled_area(at(a), at(b), at(k)) >= 0 && doubled_area(at(b), at(c), at(k)) >= 0 &&
        doubled_area(at(c), at(a), at(k)) >= -1e-12 * size)
      return -1;
  }
  const Vector2 u = at(a) - at(b), v = at(c) - at(b);
  return std::atan2(std::abs(u.x() * v.y() - u.y() * v.x()), u.dot(v));
}

/// Cuts off the sharpest ear, again and again.
std::vector<Triangle> cut_ears(const std::vector<Vector2>& p) {
  std::vector<int> left(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) left[i] = static_cast<int>(i);
  std::vector<double> angle(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) angle[i] = ear_angle(p, left, i);
  std::vector<Triangle> triangles;
  while (left.size() > 3) {
    std::size_t best = left.size();
    const auto look = [&] {
      for (std::size_t i = 0; i < left.size(); ++i)
        if (angle[i] > 0 && (best == left.size() || angle[i] < angle[best])) best = i;
    };
    look();
    if (best == left.size()) {  // a cut may have freed an ear that is not beside it
      for (std::size_t i = 0; i < left.size(); ++i) angle[i] = ear_angle(p, left, i);
      look();
    }
    assert(best < left.size() && "a simple polygon has an ear");
    const std::size_t n = left.size();
    triangles.push_back({left[(best + n - 1) % n], left[best], left[(best + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    angle.erase(angle.begin() + static_cast<std::ptrdiff_t>(best));
    for (const std::size_t i : {(best + left.size() - 1) % left.size(), best % left.size()})
      angle[i] = ear_angle(p, left, i);
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

/// Triangles with what lies across each of their edges.
class Mesh {
 public:
  Mesh(std::vector<Vector2> points, std::vector<Triangle> triangles)
      : point_(std::move(points)), triangle_(std::move(triangles)) {
    for (std::size_t t = 0; t < triangle_.size(); ++t) enter(static_cast<int>(t));
  }

  /// Halves inner edges, the longest first, until none is longer than `limit`.
  void refine(double limit) {
    for (;;) {
      std::vector<std::pair<double, Edge>> longer;  // −length, so that sorting puts the longest first
      for (const auto& [edge, owner] : owner_)
        if (edge.first < edge.second && is_inner(edge) && length(edge) > limit * (1 + 1e-9))
          longer.emplace_back(-length(edge), edge);
      if (longer.empty()) return;
      std::sort(longer.begin(), longer.end());
      for (const auto& [size, edge] : longer)
        if (owner_.contains(edge) && is_inner(edge)) flip_around(halve(edge));
    }
  }

  void flip_all() {
    std::vector<Edge> edges;
    for (const auto& [edge, owner] : owner_)
      if (edge.first < edge.second) edges.push_back(edge);
    flip_around(std::move(edges));
  }

  Triangulation result() && { return {std::move(point_), std::move(triangle_)}; }

 private:
  const Vector2& at(int k) const { return point_[static_cast<std::size_t>(k)]; }
  double length(const Edge& edge) const { return (at(edge.first) - at(edge.second)).norm(); }
  bool is_inner(const Edge& edge) const { return owner_.contains({edge.second, edge.first}); }
  Triangle& triangle(int t) { return triangle_[static_cast<std::size_t>(t)]; }
  void enter(int t) {
    const Triangle& v = triangle(t);
    for (std::size_t k = 0; k < 3; ++k) owner_[{v[k], v[(k + 1) % 3]}] = t;
  }
  int opposite(int t, const Edge& edge) {
    for (const int v : triangle(t))
      if (v != edge.first && v != edge.second) return v;
    assert(false);
    return -1;
  }
  void set(int t, const Triangle& v) {
    triangle(t) = v;
    enter(t);
  }

  /// Turns these edges where that makes better triangles, and those around whatever was turned.
  void flip_around(std::vector<Edge> edges) {
    while (!edges.empty()) {
      const Edge edge = edges.back();
      edges.pop_back();
      const std::vector<Edge> around = flip(edge);
      edges.insert(edges.end(), around.begin(), around.end());
    }
  }

  /// The edges around the new point's triangles.
  std::vector<Edge> halve(const Edge& edge) {
    const auto [a, b] = edge;
    const int left = owner_.at({a, b}), right = owner_.at({b, a});
    const int c = opposite(left, edge), d = opposite(right, edge), m = static_cast<int>(point_.size());
    point_.push_back(0.5 * (at(a) + at(b)));
    owner_.erase({a, b});
    owner_.erase({b, a});
    const int first = static_cast<int>(triangle_.size());
    triangle_.resize(triangle_.size() + 2);
    set(left, {a, m, c});
    set(first, {m, b, c});
    set(right, {b, m, d});
    set(first + 1, {m, a, d});
    return {{a, d}, {d, b}, {b, c}, {c, a}};
  }

  /// Flips an inner edge if the two angles opposite to it sum to more than 180°. Returns the edges around it,
  /// which are tested next.
  std::vector<Edge> flip(const Edge& edge) {
    const auto [a, b] = edge;
    const auto one = owner_.find({a, b}), other = owner_.find({b, a});
    if (one == owner_.end() || other == owner_.end()) return {};
    const int left = one->second, right = other->second;
    const int c = opposite(left, edge), d = opposite(right, edge);
    const Vector2 ca = at(a) - at(c), cb = at(b) - at(c), da = at(a) - at(d), db = at(b) - at(d);
    const double cross_c = ca.x() * cb.y() - ca.y() * cb.x(), cross_d = db.x() * da.y() - db.y() * da.x();
    // sin(γ + δ) < 0, beyond round-off
    const double sine = cross_c * db.dot(da) + ca.dot(cb) * cross_d;
    const double size = ca.norm() * cb.norm() * da.norm() * db.norm();
    if (sine >= -1e-12 * size) return {};
    // The quadrilateral must be convex, or the turned edge would leave it.
    if (doubled_area(at(d), at(b), at(c)) <= 0 || doubled_area(at(c), at(a), at(d)) <= 0) return {};
    owner_.erase({a, b});
    owner_.erase({b, a});
    set(left, {a, d, c});
    set(right, {d, b, c});
    return {{a, d}, {d, b}, {b, c}, {c, a}};
  }

  std::vector<Vector2> point_;
  std::vector<Triangle> triangle_;
  std::map<Edge, int> owner_;
};

}  // namespace

Triangulation triangulate(const std::vector<Vector2>& polygon, double spacing) {
  Mesh mesh(polygon, cut_ears(polygon));
  mesh.flip_all();
  mesh.refine(1.5 * spacing);
  return std::move(mesh).result();
}

}  // namespace strake::structure
