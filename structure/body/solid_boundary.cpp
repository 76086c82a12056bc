#include "proto/error.hpp"
#include "structure/body/shape.hpp"
#include "structure/body/solid.hpp"
#include "structure/body/solid_surface.hpp"
#include "structure/body/surface.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace strake::structure {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Corners of a closed chain: where it turns by more than round-off.
std::vector<Vector2d> corners(const std::vector<Vector2d>& chain) {
  constexpr double straight = 1e-9;  // sine of the turn
  std::vector<Vector2d> kept;
  const std::size_t n = chain.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector2d in = chain[i] - chain[(i + n - 1) % n], out = chain[(i + 1) % n] - chain[i];
    if (std::abs(in.x() * out.y() - in.y() * out.x()) > straight * in.norm() * out.norm())
      kept.push_back(chain[i]);
  }
  return kept;
}

/// The lowest corner comes first, of several the leftmost.
void start_at_lower_left(std::vector<Vector2d>& polygon) {
  const auto first = std::min_element(
      polygon.begin(), polygon.end(),
      [](const Vector2d& a, const Vector2d& b) { return a.y() != b.y() ? a.y() < b.y() : a.x() < b.x(); });
  std::rotate(polygon.begin(), first, polygon.end());
}

/// Finds the facets that are connected over their edges. Each facet gets the number of the first facet of its
/// group.
std::vector<int> groups_of_facets(const Solid& solid) {
  std::vector<int> group(solid.facet_cell.size());
  std::iota(group.begin(), group.end(), 0);
  const auto root = [&](int f) {
    while (group[static_cast<std::size_t>(f)] != f) f = group[static_cast<std::size_t>(f)];
    return f;
  };
  std::map<std::pair<int, int>, int> seen;
  for (int f = 0; f < solid.facet.cols(); ++f)
    for (int k = 0; k < 4; ++k) {
      const auto edge = std::minmax(solid.facet(k, f), solid.facet((k + 1) % 4, f));
      const auto [found, fresh] = seen.emplace(edge, f);
      if (fresh) continue;
      const int a = root(f), b = root(found->second);
      group[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  for (int f = 0; f < solid.facet.cols(); ++f) group[static_cast<std::size_t>(f)] = root(f);
  return group;
}

/// Points of a triangulated surface, those nearer together than round-off being one.
class PointSet {
 public:
  explicit PointSet(double near) : near_(near) {}
  int add(const Vector3d& X) {
    const auto key = [&](double x) { return std::llround(x / near_); };
    const auto [found, fresh] = number_.emplace(std::array<long long, 3>{key(X.x()), key(X.y()), key(X.z())},
                                                static_cast<int>(points.size()));
    if (fresh) points.push_back(X);
    return found->second;
  }
  std::vector<Vector3d> points;

 private:
  double near_;
  std::map<std::array<long long, 3>, int> number_;
};

}  // namespace

Vector3d facet_normal(const Solid& solid, int f) {
  const auto at = [&](int k) -> Vector3d { return solid.node.col(solid.facet(k, f)); };
  if (solid.dimension == 2) {
    const Vector3d t = at(1) - at(0);
    return {t.y(), -t.x(), 0};
  }
  return 0.5 * (at(2) - at(0)).cross(at(3) - at(1));
}

// Each facet leads from its first node to its second. Where two loops touch in one node the sharpest turn to
// the left closes the loop at hand: it stays with its own cells and never crosses itself.
std::vector<std::vector<Vector2d>> outer_polygons(const Solid& solid) {
  std::map<int, std::vector<int>> from;  // facets by their first node
  for (int f = 0; f < solid.facet.cols(); ++f) from[solid.facet(0, f)].push_back(f);
  const auto place = [&](int node) -> Vector2d { return solid.node.col(node).head<2>(); };
  std::vector<char> used(solid.facet_cell.size(), 0);
  std::vector<std::vector<Vector2d>> polygons;
  for (int first = 0; first < solid.facet.cols(); ++first) {
    if (used[static_cast<std::size_t>(first)]) continue;
    std::vector<Vector2d> chain;
    int f = first;
    while (f >= 0 && !used[static_cast<std::size_t>(f)]) {
      used[static_cast<std::size_t>(f)] = 1;
      chain.push_back(place(solid.facet(0, f)));
      const Vector2d along = place(solid.facet(1, f)) - place(solid.facet(0, f));
      int next = -1;
      double most = -4;  // the turn, from −π (right) to π (left)
      for (const int candidate : from[solid.facet(1, f)]) {
        if (used[static_cast<std::size_t>(candidate)]) continue;
        const Vector2d on = place(solid.facet(1, candidate)) - place(solid.facet(0, candidate));
        const double turn = std::atan2(along.x() * on.y() - along.y() * on.x(), along.dot(on));
        if (turn > most) {
          most = turn;
          next = candidate;
        }
      }
      f = next;
    }
    std::vector<Vector2d> polygon = corners(chain);
    if (polygon.size() < 3 || polygon_area(polygon) <= 0) continue;  // a cavity is walked clockwise
    start_at_lower_left(polygon);
    polygons.push_back(std::move(polygon));
  }
  return polygons;
}

InterfaceMesh outer_surface(const Solid& solid, double spacing) {
  const Vector3d size = solid.node.rowwise().maxCoeff() - solid.node.rowwise().minCoeff();
  PointSet set(1e-9 * size.maxCoeff());
  const std::vector<int> group = groups_of_facets(solid);
  std::map<int, double> volume;  // six times that which a group of facets encloses
  for (int f = 0; f < solid.facet.cols(); ++f)
    volume[group[static_cast<std::size_t>(f)]] +=
        2 * facet_normal(solid, f).dot(solid.node.col(solid.facet(0, f)) - solid.node.col(0));
  std::vector<std::array<int, 3>> faces;
  for (int f = 0; f < solid.facet.cols(); ++f) {
    if (volume.at(group[static_cast<std::size_t>(f)]) <= 0) continue;
    const auto corner = [&](int k) -> Vector3d { return solid.node.col(solid.facet(k, f)); };
    // Opposite edges of a box's facet are as long as one another, so that the parts of neighbours meet.
    // Facets of a mesh file are taken as they are.
    const auto parts = [&](int a, int b) {
      return solid.made_of_boxes()
                 ? std::max(1, static_cast<int>(std::lround((corner(b) - corner(a)).norm() / spacing)))
                 : 1;
    };
    const int n = parts(0, 1), m = parts(1, 2);
    const auto at = [&](int i, int j) {
      const double s = static_cast<double>(i) / n, r = static_cast<double>(j) / m;
      return set.add((1 - s) * (1 - r) * corner(0) + s * (1 - r) * corner(1) + s * r * corner(2) +
                     (1 - s) * r * corner(3));
    };
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < n; ++i) {
        faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }
  return closed_surface(set.points, faces);
}

bool on_facet(const Solid& solid, int facet, const Vector3d& X, double slack) {
  const auto corner = [&](Index k) -> Vector3d { return solid.node.col(solid.facet(k, facet)); };
  const Vector3d normal = facet_normal(solid, facet).normalized();
  const Index n = solid.facet.rows();
  if (std::abs(normal.dot(X - corner(0))) > slack) return false;
  if (n == 2) {
    const Vector3d t = corner(1) - corner(0);
    const double s = t.dot(X - corner(0)) / t.norm();
    return s >= -slack && s <= t.norm() + slack;
  }
  for (Index k = 0; k < n; ++k) {
    const Vector3d edge = corner((k + 1) % n) - corner(k);
    if (normal.cross(edge).dot(X - corner(k)) < -slack * edge.norm()) return false;
  }
  return true;
}

Vector3d normal_of(const Solid& solid, const SupportedFace& face) {
  Vector3d sum = Vector3d::Zero();
  for (const int f : face.facet) sum += facet_normal(solid, f);
  return sum.normalized();
}

Index axis_of(const Solid& solid, const SupportedFace& face) {
  Index axis = 0;
  if (normal_of(solid, face).cwiseAbs().maxCoeff(&axis) > 1 - 1e-6) return axis;
  throw Error(
      ExitCode::case_file, "structure, support \"" + face.name + "\"",
      "a face that rolls or is one of symmetry must lie across x, y or z, for particles a pinned one too",
      "clamped, or turn the body");
}

Vector3d shorter_direction(const Solid& solid, const SupportedFace& face) {
  const Vector3d normal = normal_of(solid, face);
  if (solid.dimension == 2) return Vector3d(-normal.y(), normal.x(), 0);
  // Two directions within the face: the axis that is most nearly in it, and the one across that.
  Index axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  const Vector3d one = (Vector3d::Unit(axis) - normal[axis] * normal).normalized(), other = normal.cross(one);
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const int f : face.facet)
    for (Index k = 0; k < solid.facet.rows(); ++k) {
      const Vector3d X = solid.node.col(solid.facet(k, f));
      const Vector3d reach(one.dot(X), other.dot(X), 0);
      low = low.cwiseMin(reach);
      high = high.cwiseMax(reach);
    }
  return (high - low).x() <= (high - low).y() ? one : other;
}

Vector3d middle_of(const Solid& solid, const SupportedFace& face) {
  Vector3d low = solid.node.col(solid.facet(0, face.facet.front())), high = low;
  for (const int f : face.facet)
    for (Index k = 0; k < solid.facet.rows(); ++k) {
      low = low.cwiseMin(solid.node.col(solid.facet(k, f)));
      high = high.cwiseMax(solid.node.col(solid.facet(k, f)));
    }
  return 0.5 * (low + high);
}

}  // namespace strake::structure
