#include "fluid/geometry/wet_points.hpp"

#include "fluid/geometry/triangle_grid.hpp"
#include "proto/geometry/polygon.hpp"
#include "proto/geometry/triangle.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace strake::fluid {

namespace {

using Vector3 = Eigen::Vector3d;
using Vector2 = Eigen::Vector2d;

/// Largest distance between samples of a surface [l0].
constexpr double sample_distance = 0.2;
/// Number of rounds in which each place moves to the middle of the samples nearest to it.
constexpr int rounds = 40;
constexpr double round_off = 1e-9;

Vector3 corner(const InterfaceMesh& mesh, int triangle, int k) {
  return mesh.position.col(mesh.faces(k, triangle));
}
Vector3 normal_of(const InterfaceMesh& mesh, int t) {
  return (corner(mesh, t, 1) - corner(mesh, t, 0)).cross(corner(mesh, t, 2) - corner(mesh, t, 0));
}

double area_of(const InterfaceMesh& mesh, const std::vector<int>& triangles) {
  double area = 0;
  for (const int t : triangles) area += 0.5 * normal_of(mesh, t).norm();
  return area;
}

/// Numbers the parts on which wet points stand, one for each triangle: those between corners, chines and
/// knuckles. A part is joined with those beyond its knuckles where it is too narrow for rows of its own:
///   2 A/L < l0/2 ,   A its area, L the length of its edges; for a long strip 2 A/L is its width.
std::vector<int> parts_of(const InterfaceMesh& mesh, const SurfacePatches& patches, double spacing) {
  std::vector<int> part = patches.part_of_triangle;
  const auto count = 1 + static_cast<std::size_t>(std::ranges::max(part));
  const auto of = [&](int t) { return static_cast<std::size_t>(part[static_cast<std::size_t>(t)]); };
  std::vector<double> area(count, 0), length(count, 0);
  for (int t = 0; t < static_cast<int>(part.size()); ++t) area[of(t)] += 0.5 * normal_of(mesh, t).norm();
  for (const auto* sides : {&patches.border, &patches.chine, &patches.knuckle})
    for (const auto& edge : *sides)
      length[of(edge.triangle)] += (mesh.position.col(edge.to) - mesh.position.col(edge.from)).norm();
  std::vector<std::size_t> joined(count);
  std::iota(joined.begin(), joined.end(), 0u);
  const auto root = [&](std::size_t k) {
    while (joined[k] != k) k = joined[k];
    return k;
  };
  for (const auto& edge : patches.knuckle) {
    const std::size_t k = of(edge.triangle), a = root(k), b = root(of(edge.other_triangle));
    if (4 * area[k] < spacing * length[k]) joined[std::max(a, b)] = std::min(a, b);
  }
  for (int& p : part) p = static_cast<int>(root(static_cast<std::size_t>(p)));
  return part;
}

/// Axes of a plane part of a patch that is a rectangle.
struct Rectangle {
  Vector3 origin, along, across;
  double length = 0, width = 0;
  Vector2 place(const Vector3& x) const { return {along.dot(x - origin), across.dot(x - origin)}; }
};

std::optional<Rectangle> rectangle_of(const InterfaceMesh& mesh, const SurfacePatches& patches,
                                      const std::vector<int>& part, const std::vector<int>& triangles) {
  const Vector3 normal = normal_of(mesh, triangles.front()).normalized();
  for (const int t : triangles)
    if ((normal_of(mesh, t).normalized() - normal).norm() > 1e-6) return {};
  Rectangle box;
  double longest = 0;
  const auto of = [&](int t) { return part[static_cast<std::size_t>(t)]; };
  for (const auto* sides : {&patches.border, &patches.chine, &patches.knuckle})
    for (const auto& edge : *sides) {
      if (of(edge.triangle) != of(triangles.front())) continue;
      const Vector3 t = mesh.position.col(edge.to) - mesh.position.col(edge.from);
      if (t.norm() <= longest) continue;
      longest = t.norm();
      box.along = t / longest;
      box.origin = mesh.position.col(edge.from);
    }
  if (longest == 0) return {};
  box.across = normal.cross(box.along);
  Vector2 low = Vector2::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const int t : triangles)
    for (int k = 0; k < 3; ++k) {
      const Vector2 x = box.place(corner(mesh, t, k));
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
  box.origin += low.x() * box.along + low.y() * box.across;
  box.length = high.x() - low.x();
  box.width = high.y() - low.y();
  const double area = area_of(mesh, triangles);
  if (std::abs(box.length * box.width - area) > round_off * area) return {};
  return box;
}

class Spreading {
 public:
  Spreading(const InterfaceMesh& mesh, const SurfacePatches& patches, double spacing)
      : mesh_(mesh), patches_(patches), part_(parts_of(mesh, patches, spacing)), spacing_(spacing) {
    grid_.build(mesh.position, mesh.faces, spacing);
  }

  WetPoints run() {
    std::vector<std::vector<int>> triangles;
    for (int t = 0; t < static_cast<int>(mesh_.faces.cols()); ++t) {
      const auto part = static_cast<std::size_t>(part_[static_cast<std::size_t>(t)]);
      triangles.resize(std::max(triangles.size(), part + 1));
      triangles[part].push_back(t);
    }
    for (int part = 0; part < static_cast<int>(triangles.size()); ++part) {
      const auto& own = triangles[static_cast<std::size_t>(part)];
      if (own.empty()) continue;  // joined with another
      const int patch = patches_.of_triangle[static_cast<std::size_t>(own.front())];
      if (const auto box = rectangle_of(mesh_, patches_, part_, own))
        divide(*box, patch, own);
      else
        settle(patch, part, own);
    }
    return std::move(points_);
  }

 private:
  void divide(const Rectangle& box, int patch, const std::vector<int>& triangles) {
    const int columns = std::max(1, static_cast<int>(std::lround(box.length / spacing_)));
    const int rows = std::max(1, static_cast<int>(std::lround(box.width / spacing_)));
    const double dx = box.length / columns, dy = box.width / rows;
    const int first = static_cast<int>(points_.point.size());
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c)
        add({box.origin + (c + 0.5) * dx * box.along + (r + 0.5) * dy * box.across,
             normal_of(mesh_, triangles.front())},
            patch, triangles);
    std::map<std::pair<int, int>, double> part;
    for (const int t : triangles) {
      Polygon whole;
      Vector2 low = Vector2::Constant(std::numeric_limits<double>::infinity()), high = -low;
      for (int k = 0; k < 3; ++k) {
        whole.push_back(box.place(corner(mesh_, t, k)));
        low = low.cwiseMin(whole.back());
        high = high.cwiseMax(whole.back());
      }
      const double area = std::abs(polygon_area(whole));
      const auto cell = [](double x, double d, int n) {
        return std::clamp(static_cast<int>(std::floor(x / d)), 0, n - 1);
      };
      for (int r = cell(low.y(), dy, rows); r <= cell(high.y(), dy, rows); ++r)
        for (int c = cell(low.x(), dx, columns); c <= cell(high.x(), dx, columns); ++c) {
          const auto piece = cut_polygon(
              cut_polygon(cut_polygon(cut_polygon(whole, 0, c * dx, -1), 0, (c + 1) * dx, 1), 1, r * dy, -1),
              1, (r + 1) * dy, 1);
          if (const double share = std::abs(polygon_area(piece)) / area; share > 0)
            part[{first + r * columns + c, t}] += share;
        }
    }
    keep(part);
  }

  /// Samples of a part, each with its triangle, its area and its unit normal. to_side: across the plane that
  /// halves an edge near by that ends in the part, to the side of the sample; else zero.
  struct Sample {
    Vector3 place;
    int triangle;
    double area;
    Vector3 normal, to_side = Vector3::Zero();
  };
  struct Place {
    Vector3 middle, normal;
  };
  /// Whether the sample lies on the side of a thin body, and of such an edge, that the place is on.
  static bool on_one_side(const Sample& sample, const Place& place) {
    return sample.normal.dot(place.normal) > 0 && sample.to_side.dot(place.normal) >= 0;
  }
  /// Finds `to_side` of the samples within a spacing and a half of edges that end in the part.
  void find_sides(int part, std::vector<Sample>& samples) const {
    const auto& undivided = patches_.part_of_triangle;
    const auto ends_in_part = [&](const SurfacePatches::Border& border) {
      const auto t = static_cast<std::size_t>(border.triangle),
                 other = static_cast<std::size_t>(border.other_triangle);
      return part_[t] == part && undivided[t] == undivided[other] && border.is_within_patch();
    };
    std::vector<const SurfacePatches::Border*> chines;
    for (const auto* sides : {&patches_.border, &patches_.chine, &patches_.knuckle})
      for (const auto& border : *sides)
        if (border.is_first() && ends_in_part(border)) chines.push_back(&border);
    if (chines.empty()) return;
    Eigen::Matrix3Xi ends(3, static_cast<Eigen::Index>(chines.size()));
    for (std::size_t e = 0; e < chines.size(); ++e)
      ends.col(static_cast<Eigen::Index>(e)) << chines[e]->from, chines[e]->to, chines[e]->to;
    TriangleGrid edges;
    edges.build(mesh_.position, ends, spacing_);
    for (Sample& sample : samples) {
      const auto foot = edges.nearest(sample.place, 1.5 * spacing_);
      if (foot.triangle < 0) continue;
      const auto* chine = chines[static_cast<std::size_t>(foot.triangle)];
      const Vector3 across = normal_of(mesh_, chine->triangle).normalized() -
                             normal_of(mesh_, chine->other_triangle).normalized();
      sample.to_side = across.dot(sample.normal) > 0 ? across : Vector3(-across);
    }
  }
  std::vector<Sample> samples_of(const std::vector<int>& triangles) const {
    std::vector<Sample> samples;
    for (const int t : triangles) {
      const Vector3 a = corner(mesh_, t, 0), u = corner(mesh_, t, 1) - a, v = corner(mesh_, t, 2) - a;
      const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
      const int n = std::max(1, static_cast<int>(std::ceil(longest / (sample_distance * spacing_))));
      const double area = 0.5 * u.cross(v).norm() / (n * n);
      const Vector3 normal = u.cross(v).normalized();
      for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j) {
          samples.push_back({.place = a + ((i + 1.0 / 3) * u + (j + 1.0 / 3) * v) / n,
                             .triangle = t,
                             .area = area,
                             .normal = normal});
          if (i + j + 1 < n)
            samples.push_back({.place = a + ((i + 2.0 / 3) * u + (j + 2.0 / 3) * v) / n,
                               .triangle = t,
                               .area = area,
                               .normal = normal});
        }
    }
    return samples;
  }

  void settle(int patch, int own_part, const std::vector<int>& triangles) {
    std::vector<Sample> samples = samples_of(triangles);
    find_sides(own_part, samples);
    const double area = area_of(mesh_, triangles);
    const int count = std::max(1, static_cast<int>(std::lround(area / (spacing_ * spacing_))));
    std::vector<Place> place;
    double passed = 0;
    for (const Sample& sample : samples) {
      if (passed + sample.area > (static_cast<double>(place.size()) + 0.5) * area / count &&
          static_cast<int>(place.size()) < count)
        place.push_back({sample.place, sample.normal});
      passed += sample.area;
    }
    std::vector<int> owner(samples.size(), 0);
    for (int round = 0; round <= rounds; ++round) {
      assign(samples, place, owner);
      if (round == rounds) break;
      std::vector<Vector3> middle(place.size(), Vector3::Zero()), normal = middle;
      std::vector<double> weight(place.size(), 0);
      for (std::size_t s = 0; s < samples.size(); ++s) {
        const auto k = static_cast<std::size_t>(owner[s]);
        middle[k] += samples[s].area * samples[s].place;
        normal[k] += samples[s].area * samples[s].normal;
        weight[k] += samples[s].area;
      }
      for (std::size_t k = 0; k < place.size(); ++k)
        if (weight[k] > 0) place[k] = {middle[k] / weight[k], normal[k]};
    }
    const int first = static_cast<int>(points_.point.size());
    for (const Place& at : place) add(at, patch, triangles);
    std::map<std::pair<int, int>, double> part;
    for (std::size_t s = 0; s < samples.size(); ++s)
      part[{first + owner[s], samples[s].triangle}] +=
          samples[s].area / (0.5 * normal_of(mesh_, samples[s].triangle).norm());
    keep(part);
  }

  /// Finds the nearest place of each sample, by cells of one and a half spacings. It is one on its own side
  /// of a thin body.
  void assign(const std::vector<Sample>& samples, const std::vector<Place>& place,
              std::vector<int>& owner) const {
    const double cell = 1.5 * spacing_;
    const auto key = [&](const Vector3& x, int dx, int dy, int dz) {
      const Vector3 from = (x - grid_.low()) / cell;
      return std::array<int, 3>{static_cast<int>(std::floor(from.x())) + dx,
                                static_cast<int>(std::floor(from.y())) + dy,
                                static_cast<int>(std::floor(from.z())) + dz};
    };
    std::map<std::array<int, 3>, std::vector<int>> cells;
    for (std::size_t k = 0; k < place.size(); ++k)
      cells[key(place[k].middle, 0, 0, 0)].push_back(static_cast<int>(k));
    std::array<int, 3> last{};
    std::vector<int> near;  // of the last cell that was asked for
    bool fresh = false;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const auto here = key(samples[s].place, 0, 0, 0);
      if (!fresh || here != last) {
        near.clear();
        for (int dz = -1; dz <= 1; ++dz)
          for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
              if (const auto found = cells.find(key(samples[s].place, dx, dy, dz)); found != cells.end())
                near.insert(near.end(), found->second.begin(), found->second.end());
        last = here;
        fresh = true;
      }
      double best = std::numeric_limits<double>::infinity();
      for (const int k : near) {
        const Place& at = place[static_cast<std::size_t>(k)];
        const double squared = (at.middle - samples[s].place).squaredNorm();
        if (squared >= best || !on_one_side(samples[s], at)) continue;
        best = squared;
        owner[s] = k;
      }
      if (std::isinf(best))  // no place within a cell: the first rounds, and thin ends
        for (std::size_t k = 0; k < place.size(); ++k)
          if (const double squared = (place[k].middle - samples[s].place).squaredNorm();
              squared < best && (near.empty() || on_one_side(samples[s], place[k]))) {
            best = squared;
            owner[s] = static_cast<int>(k);
          }
    }
  }

  /// Adds the nearest place of the part. Where a body is thin another face, or the other side of this one,
  /// may be nearer.
  void add(const Place& place, int patch, const std::vector<int>& triangles) {
    const auto foot = grid_.nearest(place.middle);
    const auto faces_alike = [&](int t) { return normal_of(mesh_, t).dot(place.normal) > 0; };
    WetPoints::Point point{foot.triangle, foot.weight, patch};
    const auto part_of = [&](int t) { return part_[static_cast<std::size_t>(t)]; };
    if (part_of(foot.triangle) != part_of(triangles.front()) || !faces_alike(foot.triangle)) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const int t : triangles) {
        Eigen::Matrix3d corners;
        for (int k = 0; k < 3; ++k) corners.col(k) = corner(mesh_, t, k);
        const Vector3 weight = nearest_in_triangle(corners, place.middle);
        const double distance = (corners * weight - place.middle).norm();
        if (distance >= nearest || !faces_alike(t)) continue;
        nearest = distance;
        point.triangle = t;
        point.weight = weight;
      }
    }
    points_.point.push_back(point);
  }
  void keep(const std::map<std::pair<int, int>, double>& part) {
    for (const auto& [key, share] : part) points_.share.push_back({key.first, key.second, share});
  }

  const InterfaceMesh& mesh_;
  const SurfacePatches& patches_;
  const std::vector<int> part_;  // of the triangles
  double spacing_;
  TriangleGrid grid_;
  WetPoints points_;
};

}  // namespace

WetPoints wet_points(const InterfaceMesh& mesh, const SurfacePatches& patches, double spacing) {
  return Spreading(mesh, patches, spacing).run();
}

}  // namespace strake::fluid
