#include "fluid/air/lower_faces.hpp"
#include "proto/geometry/polygon.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

// Cells of an even grid over the plan of a field, cut along its border. A cell keeps its area, the lengths of
// its sides that lie under the field, and the pieces of the border in it.

namespace strake::fluid {
namespace {

using Vector2 = Eigen::Vector2d;

constexpr double least_part = 0.3;  // of a whole cell's area that a column of its own needs
constexpr double round_off = 1e-9;  // of a cell

/// A triangle or a piece of it, seen from above: x to the right, z up.
Vector2 seen_from_above(const Points& place, int point) {
  return {place(0, point), place(2, point)};
}

/// Sets of triangles that share edges. border: edges that one triangle of the field has alone.
struct Connected {
  struct Edge {
    int triangle, from, to;
  };
  std::vector<std::vector<int>> fields;    // triangles
  std::vector<std::vector<Edge>> borders;  // of each field
};

Connected connect(const InterfaceMesh& mesh, const std::vector<int>& triangles) {
  std::map<std::pair<int, int>, int> of_edge;  // in the triangle's own order
  for (const int t : triangles)
    for (int k = 0; k < 3; ++k) of_edge[{mesh.faces(k, t), mesh.faces((k + 1) % 3, t)}] = t;
  std::map<int, int> field_of;
  Connected out;
  for (const int first : triangles) {
    if (field_of.contains(first)) continue;
    const auto number = static_cast<int>(out.fields.size());
    std::vector<int> field{first};
    std::vector<Connected::Edge> border;
    field_of[first] = number;
    for (std::size_t next = 0; next < field.size(); ++next)
      for (int k = 0; k < 3; ++k) {
        const int a = mesh.faces(k, field[next]), b = mesh.faces((k + 1) % 3, field[next]);
        const auto beyond = of_edge.find({b, a});
        if (beyond == of_edge.end()) {
          border.push_back({field[next], a, b});
        } else if (!field_of.contains(beyond->second)) {
          field_of[beyond->second] = number;
          field.push_back(beyond->second);
        }
      }
    out.fields.push_back(std::move(field));
    out.borders.push_back(std::move(border));
  }
  return out;
}

class CutCells {
 public:
  CutCells(const Points& place, const InterfaceMesh& mesh, const std::vector<int>& triangles,
           double spacing) {
    Vector2 high = Vector2::Constant(-std::numeric_limits<double>::infinity());
    low_ = -high;
    for (const int t : triangles)
      for (int k = 0; k < 3; ++k) {
        const Vector2 x = seen_from_above(place, mesh.faces(k, t));
        low_ = low_.cwiseMin(x);
        high = high.cwiseMax(x);
      }
    for (int axis = 0; axis < 2; ++axis) {
      count_[axis] = std::max(1, static_cast<int>(std::lround((high[axis] - low_[axis]) / spacing)));
      width_[axis] = (high[axis] - low_[axis]) / count_[axis];
    }
    const auto cells = static_cast<std::size_t>(count_.prod());
    area_.assign(cells, 0);
    moment_.assign(cells, Vector2::Zero());
    length_.assign(cells, {0, 0, 0, 0});
    points_.resize(cells);
  }

  int cell_at(const Vector2& x) const {
    int index[2];
    for (int axis = 0; axis < 2; ++axis)
      index[axis] = std::clamp(static_cast<int>(std::floor((x[axis] - low_[axis]) / width_[axis])), 0,
                               count_[axis] - 1);
    return number(index[0], index[1]);
  }
  void add_point(const Vector2& x, int point) {
    points_[static_cast<std::size_t>(cell_at(x))].push_back(point);
  }

  void add(const Polygon& triangle) {
    Vector2 low = triangle[0], high = low;
    for (const Vector2& x : triangle) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    const int from = cell_at(low), to = cell_at(high);
    for (int j = from / count_[0]; j <= to / count_[0]; ++j)
      for (int i = from % count_[0]; i <= to % count_[0]; ++i) {
        const Vector2 a = line(i, j), b = line(i + 1, j + 1);
        add_piece(cut_polygon(cut_polygon(cut_polygon(cut_polygon(triangle, 0, a.x(), -1), 0, b.x(), 1), 1,
                                          a.y(), -1),
                              1, b.y(), 1),
                  number(i, j), a, b);
      }
  }

  /// Divides a piece of the border at the grid's lines. outward: its normal.
  void add_border(const Vector2& from, const Vector2& to, const Vector2& outward) {
    std::vector<double> cuts{0, 1};
    for (int axis = 0; axis < 2; ++axis)
      for (int k = 0; k <= count_[axis]; ++k) {
        const double s = (low_[axis] + k * width_[axis] - from[axis]) / (to[axis] - from[axis]);
        if (s > 0 && s < 1) cuts.push_back(s);
      }
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
      const double length = (cuts[k + 1] - cuts[k]) * (to - from).norm();
      if (length < round_off * width_.minCoeff()) continue;
      const Vector2 middle = from + 0.5 * (cuts[k] + cuts[k + 1]) * (to - from);
      border_.push_back({.column = cell_at(middle - 1e-6 * width_.minCoeff() * outward),
                         .other = -1,
                         .normal = outward,
                         .length = length,
                         .middle = middle});
    }
  }

  AirField<2> field() const {
    const std::vector<int> owner = merged();
    std::map<int, int> column_of;  // by owner
    for (std::size_t c = 0; c < area_.size(); ++c)
      if (area_[c] > 0 && owner[c] == static_cast<int>(c))
        column_of.emplace(owner[c], static_cast<int>(column_of.size()));
    const auto n = static_cast<Eigen::Index>(column_of.size());
    AirField<2> out;
    out.columns.place.setZero(2, n);
    out.columns.area.setZero(n);
    out.points.resize(column_of.size());
    for (std::size_t c = 0; c < area_.size(); ++c) {
      if (!(area_[c] > 0)) continue;
      const int column = column_of.at(owner[c]);
      out.columns.area[column] += area_[c];
      out.columns.place.col(column) += moment_[c];
      auto& points = out.points[static_cast<std::size_t>(column)];
      points.insert(points.end(), points_[c].begin(), points_[c].end());
    }
    for (Eigen::Index c = 0; c < n; ++c) out.columns.place.col(c) /= out.columns.area[c];
    for (AirColumns<2>::Side side : inner_sides()) {
      side.column = column_of.at(owner[static_cast<std::size_t>(side.column)]);
      side.other = column_of.at(owner[static_cast<std::size_t>(side.other)]);
      if (side.column != side.other) out.columns.sides.push_back(side);
    }
    for (AirColumns<2>::Side side : border_) {
      const auto owned = column_of.find(owner[static_cast<std::size_t>(side.column)]);
      if (owned == column_of.end()) continue;
      side.column = owned->second;
      out.columns.sides.push_back(side);
    }
    return out;
  }

 private:
  enum { left, right, lower, upper };
  int number(int i, int j) const { return i + count_[0] * j; }
  Vector2 line(int i, int j) const { return low_ + Vector2(i * width_[0], j * width_[1]); }

  void add_piece(const Polygon& piece, int cell, const Vector2& low, const Vector2& high) {
    if (piece.size() < 3) return;
    const auto c = static_cast<std::size_t>(cell);
    const double area = std::abs(polygon_area(piece)), near = round_off * width_.minCoeff();
    if (!(area > 0)) return;
    area_[c] += area;
    // Σ over the triangles of a fan: area · middle.
    for (std::size_t k = 1; k + 1 < piece.size(); ++k)
      moment_[c] += std::abs(0.5 * cross(piece[k] - piece[0], piece[k + 1] - piece[0])) *
                    (piece[0] + piece[k] + piece[k + 1]) / 3;
    for (std::size_t k = 0; k < piece.size(); ++k) {
      const Vector2 &a = piece[k], &b = following(piece, k);
      const auto on = [&](int axis, double x) {
        return std::abs(a[axis] - x) < near && std::abs(b[axis] - x) < near;
      };
      const double length = (b - a).norm();
      if (on(0, low.x())) length_[c][left] += length;
      if (on(0, high.x())) length_[c][right] += length;
      if (on(1, low.y())) length_[c][lower] += length;
      if (on(1, high.y())) length_[c][upper] += length;
    }
  }

  std::vector<AirColumns<2>::Side> inner_sides() const {
    std::vector<AirColumns<2>::Side> sides;
    for (int j = 0; j < count_[1]; ++j)
      for (int i = 0; i < count_[0]; ++i)
        for (int axis = 0; axis < 2; ++axis) {
          const int next_i = i + (axis == 0 ? 1 : 0), next_j = j + (axis == 1 ? 1 : 0);
          if (next_i >= count_[0] || next_j >= count_[1]) continue;
          const int a = number(i, j), b = number(next_i, next_j);
          const double length = std::min(length_[static_cast<std::size_t>(a)][axis == 0 ? right : upper],
                                         length_[static_cast<std::size_t>(b)][axis == 0 ? left : lower]);
          if (!(length > round_off * width_.minCoeff())) continue;
          const Vector2 middle = 0.5 * (line(next_i, next_j) + line(i + 1, j + 1));
          sides.push_back(
              {.column = a, .other = b, .normal = Vector2::Unit(axis), .length = length, .middle = middle});
        }
    return sides;
  }

  /// The cell whose column each cell belongs to. Cells that are small or without a wet point go, the smallest
  /// first, to the one with the longest side in common.
  std::vector<int> merged() const {
    std::vector<std::size_t> owner(area_.size());
    std::iota(owner.begin(), owner.end(), std::size_t{0});
    const auto owner_of = [&owner](std::size_t c) {
      while (owner[c] != c) c = owner[c] = owner[owner[c]];
      return c;
    };
    std::vector<double> area = area_;
    std::vector<std::size_t> points(area_.size());
    const std::vector<AirColumns<2>::Side> sides = inner_sides();
    std::vector<std::vector<std::size_t>> sides_of(area_.size());  // in their order, so that sums keep theirs
    for (std::size_t s = 0; s < sides.size(); ++s)
      for (const int c : {sides[s].column, sides[s].other})
        sides_of[static_cast<std::size_t>(c)].push_back(s);
    std::set<std::pair<double, std::size_t>> small;  // by area, then by number
    const auto sort_in = [&](std::size_t c) {
      if (area[c] > 0 && (area[c] < least_part * width_.prod() || points[c] == 0)) small.insert({area[c], c});
    };
    for (std::size_t c = 0; c < points.size(); ++c) {
      points[c] = points_[c].size();
      sort_in(c);
    }
    while (!small.empty()) {
      const std::size_t from = small.begin()->second;
      small.erase(small.begin());
      std::map<std::size_t, double> shared;
      for (const std::size_t s : sides_of[from]) {
        const std::size_t a = owner_of(static_cast<std::size_t>(sides[s].column)),
                          b = owner_of(static_cast<std::size_t>(sides[s].other));
        if (a != b) shared[a == from ? b : a] += sides[s].length;
      }
      if (shared.empty()) continue;  // a single cell
      const std::size_t to = std::max_element(shared.begin(), shared.end(), [](const auto& a, const auto& b) {
                               return a.second < b.second;
                             })->first;
      small.erase({area[to], to});
      owner[from] = to;
      area[to] += area[from];
      points[to] += points[from];
      sides_of[to] = joined(sides_of[to], sides_of[from]);
      sort_in(to);
    }
    std::vector<int> found(owner.size());
    for (std::size_t c = 0; c < owner.size(); ++c) found[c] = static_cast<int>(owner_of(c));
    return found;
  }

  /// The numbers of two rising lists in one; those of both are sides between them, and go.
  static std::vector<std::size_t> joined(const std::vector<std::size_t>& one,
                                         const std::vector<std::size_t>& other) {
    std::vector<std::size_t> all;
    std::set_symmetric_difference(one.begin(), one.end(), other.begin(), other.end(),
                                  std::back_inserter(all));
    return all;
  }

  Vector2 low_, width_;
  Eigen::Array2i count_;
  std::vector<double> area_;                   // of each cell under the field [m²]
  std::vector<Vector2> moment_;                // ∫ x dA
  std::vector<std::array<double, 4>> length_;  // of its sides under the field [m]
  std::vector<std::vector<int>> points_;       // wet points
  std::vector<AirColumns<2>::Side> border_;    // by cells
};

}  // namespace

std::vector<AirField<2>> columns_under_triangles(const InterfaceMesh& mesh, const Points& place,
                                                 const std::vector<int>& looks_down,
                                                 const std::vector<std::vector<int>>& points_of,
                                                 const Eigen::Matrix2Xd& point_place, double spacing) {
  const Connected connected = connect(mesh, looks_down);
  std::vector<AirField<2>> fields;
  for (std::size_t f = 0; f < connected.fields.size(); ++f) {
    CutCells cells(place, mesh, connected.fields[f], spacing);
    for (const int t : connected.fields[f]) {
      Polygon seen;
      for (int k = 0; k < 3; ++k) seen.push_back(seen_from_above(place, mesh.faces(k, t)));
      cells.add(seen);
      for (const int point : points_of[static_cast<std::size_t>(t)])
        cells.add_point(point_place.col(point), point);
    }
    for (const Connected::Edge& edge : connected.borders[f]) {
      const Vector2 from = seen_from_above(place, edge.from), to = seen_from_above(place, edge.to);
      // The third corner lies inside.
      int third = 0;
      for (int k = 0; k < 3; ++k)
        if (mesh.faces(k, edge.triangle) != edge.from && mesh.faces(k, edge.triangle) != edge.to)
          third = mesh.faces(k, edge.triangle);
      if (!((to - from).norm() > 0)) continue;
      Vector2 outward(to.y() - from.y(), from.x() - to.x());
      if (outward.dot(seen_from_above(place, third) - from) > 0) outward = -outward;
      cells.add_border(from, to, outward.normalized());
    }
    AirField<2> field = cells.field();
    const auto has_points = [](const std::vector<int>& points) { return !points.empty(); };
    if (field.columns.size() > 0 && std::all_of(field.points.begin(), field.points.end(), has_points))
      fields.push_back(std::move(field));  // else it is smaller than a cell
  }
  return fields;
}

}  // namespace strake::fluid
