#include "proto/error.hpp"
#include "structure/body/shape.hpp"
#include "structure/body/solid.hpp"
#include "structure/body/solid_surface.hpp"
#include "structure/body/surface.hpp"

#include <Eigen/Eigenvalues>
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

namespace {

/// Height over the plane through its corners 0 and 2, along the unit normal, of the bilinear surface of a
/// facet in space at a place X beside it:
///   x = (1−s)(1−r) c_0 + s(1−r) c_1 + s r c_2 + (1−s) r c_3
/// Corners 1 and 3 of a warped facet stand higher than 0 and 2, or lower: the normal is that of both
/// diagonals. (s, r) follows by Newton's method from the projections along the normal.
double height_of_facet(const Solid& solid, int facet, const Vector3d& normal, const Vector3d& X) {
  const auto corner = [&](Index k) -> Vector3d { return solid.node.col(solid.facet(k, facet)); };
  const Vector3d origin = corner(0), e1 = (corner(2) - origin).normalized(), e2 = normal.cross(e1);
  const auto flat = [&](const Vector3d& x) { return Vector2d(e1.dot(x - origin), e2.dot(x - origin)); };
  const Vector2d b = flat(corner(1)), c = flat(corner(2)), d = flat(corner(3)), wanted = flat(X);
  double s = 0.5, r = 0.5;
  constexpr int steps = 12;  // convergence is quadratic
  for (int k = 0; k < steps; ++k) {
    const Vector2d along_s = (1 - r) * b + r * (c - d), along_r = s * (c - b) + (1 - s) * d,
                   missing = wanted - (s * (1 - r) * b + s * r * c + (1 - s) * r * d);
    const double det = cross(along_s, along_r);
    if (det == 0) break;
    s += cross(missing, along_r) / det;
    r += cross(along_s, missing) / det;
  }
  return normal.dot(corner(1) - origin) * (s * (1 - r) + (1 - s) * r);
}

}  // namespace

bool on_facet(const Solid& solid, int facet, const Vector3d& X, double slack) {
  const auto corner = [&](Index k) -> Vector3d { return solid.node.col(solid.facet(k, facet)); };
  const Vector3d normal = facet_normal(solid, facet).normalized();
  const Index n = solid.facet.rows();
  const double height = normal.dot(X - corner(0)), warp = n == 2 ? 0 : normal.dot(corner(1) - corner(0));
  if (std::abs(height) > slack + std::abs(warp)) return false;
  if (n == 2) {
    const Vector3d t = corner(1) - corner(0);
    const double s = t.dot(X - corner(0)) / t.norm();
    return s >= -slack && s <= t.norm() + slack;
  }
  for (Index k = 0; k < n; ++k) {
    const Vector3d edge = corner((k + 1) % n) - corner(k);
    if (normal.cross(edge).dot(X - corner(k)) < -slack * edge.norm()) return false;
  }
  if (std::abs(warp) <= slack) return std::abs(height) <= slack;
  return std::abs(height - height_of_facet(solid, facet, normal, X)) <= slack;
}

Vector3d normal_of(const Solid& solid, const SupportedFace& face) {
  Vector3d sum = Vector3d::Zero();
  for (const int f : face.facet) sum += facet_normal(solid, f);
  return sum.normalized();
}

// What holds a line at a face's middle holds it along an axis: the face's edges lie along axes too.
Index axis_of(const Solid& solid, const SupportedFace& face) {
  constexpr double straight = 1 - 1e-6;  // cosine of the angle to an axis
  const bool line = face.support == Support::pinned || face.support == Support::roller;
  Index axis = 0;
  if (normal_of(solid, face).cwiseAbs().maxCoeff(&axis) > straight &&
      (!line || shorter_direction(solid, face).cwiseAbs().maxCoeff() > straight))
    return axis;
  throw Error(ExitCode::case_file, "structure, support \"" + face.name + "\"",
              "a face that rolls or is one of symmetry must lie across x, y or z, and the edges of one that "
              "rolls along them; for particles those of a pinned one too",
              "clamped, or turn the body");
}

namespace {

/// Extents [m] of a face along a direction in it and the one across that, and whether these are the edges of
/// a rectangle that the face fills.
struct Extents {
  Extents(const Solid& solid, const SupportedFace& face, const Vector3d& normal, const Vector3d& along)
      : one(along), other(normal.cross(along)) {
    Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    double area = 0;
    for (const int f : face.facet) {
      area += facet_normal(solid, f).norm();
      for (Index k = 0; k < solid.facet.rows(); ++k) {
        const Vector3d X = solid.node.col(solid.facet(k, f));
        const Vector3d reach(one.dot(X), other.dot(X), 0);
        low = low.cwiseMin(reach);
        high = high.cwiseMax(reach);
      }
    }
    constexpr double round_off = 1e-6;
    size = (high - low).head<2>();
    rectangle = area >= (1 - round_off) * size.prod();
  }
  const Vector3d& shorter() const { return size.x() <= size.y() ? one : other; }
  Vector3d one, other;
  Vector2d size;
  bool rectangle = false;
};

/// The direction in a face along which its second moment of area is smallest. Of a triangle with the corners
/// x_i and the area A it is A/12 (Σ x_i x_iᵀ + Σ x_i Σ x_iᵀ).
Vector3d slender_direction(const Solid& solid, const SupportedFace& face, const Vector3d& normal) {
  const Vector3d middle = middle_of(solid, face);  // near the face, so that round-off stays small
  double area = 0;
  Vector3d first = Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const int f : face.facet)
    for (const Index k : {1, 2}) {
      Eigen::Matrix3d x;
      x << solid.node.col(solid.facet(0, f)) - middle, solid.node.col(solid.facet(k, f)) - middle,
          solid.node.col(solid.facet(k + 1, f)) - middle;
      const double A = 0.5 * (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm();
      const Vector3d sum = x.rowwise().sum();
      area += A;
      first += A / 3 * sum;
      second += A / 12 * (x * x.transpose() + sum * sum.transpose());
    }
  second -= first * first.transpose() / area;
  second += second.trace() * normal * normal.transpose();  // out of the face: the largest
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(second).eigenvectors().col(0);
}

}  // namespace

// The axes of the body, turned with it, or else the edges of a rectangle that lies askew to them.
Vector3d shorter_direction(const Solid& solid, const SupportedFace& face) {
  const Vector3d normal = normal_of(solid, face);
  if (solid.dimension == 2) return Vector3d(-normal.y(), normal.x(), 0);
  Index axis = 0;  // that is most nearly in the face
  (solid.turn.transpose() * normal).cwiseAbs().minCoeff(&axis);
  const Vector3d own = solid.turn.col(axis);
  const Extents by_axes(solid, face, normal, (own - normal.dot(own) * normal).normalized());
  if (by_axes.rectangle) return by_axes.shorter();
  const Extents askew(solid, face, normal, slender_direction(solid, face, normal));
  return askew.rectangle ? askew.shorter() : by_axes.shorter();
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
