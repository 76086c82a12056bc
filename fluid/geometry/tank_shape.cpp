#include "fluid/geometry/tank_shape.hpp"

#include "proto/geometry/corner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace strake::fluid {
namespace {

using Vector2 = Eigen::Vector2d;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double lattice_tolerance = 1e-6;  // [l0]
/// Smallest distance between two layer particles [l0], `taken`. A place may be nearer to another face than to
/// its own by less than `foreign` [l0]. Otherwise it belongs to that other face.
constexpr double taken = 0.7, foreign = 0.25;
constexpr double level_floor = 0.7;  // least vertical part of a floor's normal

double distance_to_segment(const Vector2& x, const Vector2& a, const Vector2& b) {
  const Vector2 t = b - a;
  return (x - a - std::clamp((x - a).dot(t) / t.squaredNorm(), 0.0, 1.0) * t).norm();
}

/// Occupied places, by cells of one spacing.
class Places {
 public:
  explicit Places(double spacing) : spacing_(spacing) {}
  bool take(const Vector2& x) {
    const auto [cx, cy] = cell(x);
    for (long dy = -1; dy <= 1; ++dy)
      for (long dx = -1; dx <= 1; ++dx)
        if (const auto found = cells_.find({cx + dx, cy + dy}); found != cells_.end())
          for (const Vector2& other : found->second)
            if ((other - x).norm() < taken * spacing_) return false;
    cells_[{cx, cy}].push_back(x);
    return true;
  }

 private:
  std::pair<long, long> cell(const Vector2& x) const {
    return {static_cast<long>(std::floor(x.x() / spacing_)), static_cast<long>(std::floor(x.y() / spacing_))};
  }
  double spacing_;
  std::map<std::pair<long, long>, std::vector<Vector2>> cells_;
};

}  // namespace

template <int dim>
TankShape<dim>::TankShape(const Parameters& p)
    : spacing_(p.spacing),
      low_(p.tank.min.head<dim>()),
      high_(p.tank.max.head<dim>()),
      open_top_(p.open_top),
      absorbing_bottom_(p.absorbing_bottom),
      absorbing_sides_(p.absorbing_sides),
      periodic_(p.periodic) {
  if constexpr (dim == 2) {
    const std::size_t n = p.tank_polygon.size();
    if (n == 0) return;
    low_ = high_ = p.tank_polygon.front().template head<2>();
    for (const auto& corner : p.tank_polygon) {
      low_ = low_.cwiseMin(corner.template head<2>());
      high_ = high_.cwiseMax(corner.template head<2>());
    }
    for (std::size_t k = 0; k < n; ++k) {
      Edge edge;
      edge.from = p.tank_polygon[k].template head<2>();
      edge.to = p.tank_polygon[(k + 1) % n].template head<2>();
      edge.length = (edge.to - edge.from).norm();
      edge.along = (edge.to - edge.from) / edge.length;
      edge.normal = {-edge.along.y(), edge.along.x()};
      edge.wall = !(p.open_top && k + 1 == n);
      const Eigen::Index axis = std::abs(edge.normal.x()) > std::abs(edge.normal.y()) ? 0 : 1;
      const double line = (edge.from[axis] - low_[axis]) / spacing_;
      edge.on_lattice = std::abs(edge.along[axis]) * edge.length <= lattice_tolerance * spacing_ &&
                        std::abs(line - std::round(line)) <= lattice_tolerance;
      edges_.push_back(edge);
    }
  }
}

template <int dim>
WallParticles<dim> TankShape<dim>::particles(int dummy_rows) const {
  if constexpr (dim == 2) {
    if (!edges_.empty()) return polygon_particles(dummy_rows);
  }
  WallParticles<dim> all;
  visit_box(dummy_rows, [&](const WallParticle<dim>& particle, bool first_layer) {
    (first_layer ? all.wall : all.dummy).push_back(particle);
  });
  return all;
}

template <int dim>
void TankShape<dim>::for_each_particle(int dummy_rows, const VisitParticle& visit) const {
  if (edges_.empty()) return visit_box(dummy_rows, visit);
  const WallParticles<dim> all = particles(dummy_rows);
  for (const auto& particle : all.wall) visit(particle, true);
  for (const auto& particle : all.dummy) visit(particle, false);
}

/// Places layer particles around the box, on all sides that have a wall. The layer of a cell is its distance
/// from the box in cells.
template <int dim>
void TankShape<dim>::visit_box(int dummy_rows, const VisitParticle& visit) const {
  std::array<long, 3> cells{1, 1, 1}, before{0, 0, 0}, behind{0, 0, 0};
  for (int d = 0; d < dim; ++d) {
    const auto k = static_cast<std::size_t>(d);
    cells[k] = std::lround((high_[d] - low_[d]) / spacing_);
    if (periodic_[k]) continue;
    before[k] = 1 + dummy_rows;
    if (d != 1 || !open_top_) behind[k] = 1 + dummy_rows;
  }
  const double face = std::pow(spacing_, dim - 1);
  std::array<long, 3> c{};
  const auto is_inside = [&](std::size_t d) { return d >= dim || (c[d] >= 0 && c[d] < cells[d]); };
  for (c[2] = -before[2]; c[2] < cells[2] + behind[2]; ++c[2])
    for (c[1] = -before[1]; c[1] < cells[1] + behind[1]; ++c[1])
      for (c[0] = -before[0]; c[0] < cells[0] + behind[0]; ++c[0]) {
        if (c[0] == 0 && is_inside(1) && is_inside(2)) c[0] = cells[0];  // past the inside of the box
        if (c[0] >= cells[0] + behind[0]) break;
        long layer = 0;
        int sides = 0;
        WallParticle<dim> particle;
        for (int d = 0; d < dim; ++d) {
          const auto k = static_cast<std::size_t>(d);
          particle.position[d] = low_[d] + (static_cast<double>(c[k]) + 0.5) * spacing_;
          const long out = std::max(-c[k], c[k] - cells[k] + 1);
          if (out <= 0) continue;
          layer = std::max(layer, out);
          particle.normal[d] = c[k] < 0 ? 1 : -1;
          const bool absorbs = d == 1 ? absorbing_bottom_ && c[k] < 0 : absorbing_sides_;
          if (absorbs) particle.absorbing[d] = particle.normal[d];
          ++sides;
        }
        if (layer == 0) continue;
        particle.floor = c[1] < 0;
        if (sides > 1) particle.normal.setZero();
        particle.area = face * particle.normal;
        visit(particle, layer == 1);
      }
}

template <int dim>
bool TankShape<dim>::joins(std::size_t edge) const {
  return edges_[edge].wall && edges_[(edge + 1) % edges_.size()].wall;
}

/// Returns the point where the layers at `depth` behind an edge and the next one meet:
///   v − d (n₁ + n₂)/(1 + n₁·n₂).
template <int dim>
Eigen::Vector2d TankShape<dim>::mitre(std::size_t edge, double depth) const {
  const Edge &one = edges_[edge], &two = edges_[(edge + 1) % edges_.size()];
  return one.to - depth * (one.normal + two.normal) / (1 + one.normal.dot(two.normal));
}

/// Divides the layer at `depth` behind an edge into equal intervals. A corner is at the layer's end, an open
/// rim half an interval beyond it. The corner at its end is the first place of the next edge's layer.
template <int dim>
auto TankShape<dim>::row_of(std::size_t e, double depth) const -> Row {
  const std::size_t before = (e + edges_.size() - 1) % edges_.size();
  const Edge& edge = edges_[e];
  Row row;
  row.starts = joins(before);
  row.ends = joins(e);
  row.from = row.starts ? mitre(before, depth) : Vector2(edge.from - depth * edge.normal);
  const Vector2 to = row.ends ? mitre(e, depth) : Vector2(edge.to - depth * edge.normal);
  row.length = (to - row.from).dot(edge.along);
  const double halves = (row.starts ? 0 : 0.5) + (row.ends ? 0 : 0.5);
  // A length of n + ½ intervals is divided into n longer ones, whatever round-off gives.
  const long intervals = std::max(1L, std::lround(row.length / spacing_ - halves - lattice_tolerance));
  row.interval = row.length / (static_cast<double>(intervals) + halves);
  row.count = intervals + (row.ends ? 0 : 1);
  return row;
}

template <int dim>
WallParticles<dim> TankShape<dim>::polygon_particles(int dummy_rows) const {
  WallParticles<dim> all;
  if constexpr (dim == 2) {
    Places places(spacing_);
    const std::size_t n = edges_.size();
    // No water is within reach of a place deeper than a square corner's last dummy.
    const double deepest = std::sqrt(2.0) * (dummy_rows + 0.5) * spacing_ * (1 + lattice_tolerance);
    for (int row = 0; row <= dummy_rows; ++row) {
      const double depth = (row + 0.5) * spacing_;
      auto& list = row == 0 ? all.wall : all.dummy;
      for (std::size_t e = 0; e < n; ++e) {
        const Edge &edge = edges_[e], &last = edges_[(e + n - 1) % n];
        if (!edge.wall) continue;
        const Row line = row_of(e, depth);
        if (line.length <= foreign * spacing_) continue;  // the faces on both sides have met
        const bool starts = line.starts, ends = line.ends;
        for (long j = 0; j < line.count; ++j) {
          const Vector2 x =
              line.from + (static_cast<double>(j) + (starts ? 0 : 0.5)) * line.interval * edge.along;
          const Nearest near = nearest(x, true);
          if (near.inside || near.distance < depth - foreign * spacing_ || near.distance > deepest) continue;
          if (!places.take(x)) continue;
          WallParticle<dim> particle{x};
          const bool corner = j == 0 && starts;
          // Beyond the end of its face, or in the mitre, the particle also represents the face around the
          // corner.
          const double s = (x - edge.from).dot(edge.along), slack = lattice_tolerance * spacing_;
          const Edge* other = starts && (corner || s < -slack)  ? &last
                              : ends && s > edge.length + slack ? &edges_[(e + 1) % n]
                                                                : nullptr;
          particle.normal = corner ? (last.normal + edge.normal).normalized() : edge.normal;
          if (other &&
              std::abs(std::acos(std::clamp(other->along.dot(edge.along), -1.0, 1.0))) > corner_angle)
            particle.normal.setZero();
          for (const Edge* face : {&edge, other}) {
            if (!face) continue;
            const bool bottom = face->normal.y() > level_floor,
                       side = std::abs(face->normal.y()) <= level_floor;
            if ((bottom && absorbing_bottom_) || (side && absorbing_sides_))
              particle.absorbing += face->normal;
          }
          particle.floor = edge.normal.y() > level_floor || (other && other->normal.y() > level_floor);
          // The area is the stretch of the face that is nearest to the particle. At a corner it reaches to
          // the face's end.
          if (row == 0) {
            const double from = corner ? 0 : s - 0.5 * line.interval, to = s + 0.5 * line.interval;
            particle.area = std::max(0.0, std::min(edge.length, to) - std::max(0.0, from)) * edge.normal;
            if (corner) {
              const double start =
                  (x - last.from).dot(last.along) - 0.5 * row_of((e + n - 1) % n, depth).interval;
              particle.area += std::clamp(last.length - start, 0.0, last.length) * last.normal;
            }
          }
          list.push_back(particle);
        }
      }
    }
  }
  return all;
}

template <int dim>
auto TankShape<dim>::nearest(const Vector<dim>& x, bool walls_alone) const -> Nearest {
  Nearest best{0, infinity, false};
  if constexpr (dim == 2) {
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const Edge& edge = edges_[e];
      const Vector2 &a = edge.from, &b = edge.to;
      if ((a.y() > x.y()) != (b.y() > x.y()) &&
          x.x() < a.x() + (x.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
        best.inside = !best.inside;
      if (walls_alone && !edge.wall) continue;
      const double d = distance_to_segment(x, a, b);
      if (d < best.distance) {
        best.distance = d;
        best.edge = e;
      }
    }
  }
  return best;
}

template <int dim>
double TankShape<dim>::distance(const Vector<dim>& x) const {
  if (!edges_.empty()) {
    const Nearest wall = nearest(x, true);
    const bool in = wall.inside || !edges_[nearest(x, false).edge].wall;
    return in ? wall.distance : -wall.distance;
  }
  double distance = infinity;
  for (int d = 0; d < dim; ++d) {
    if (periodic_[static_cast<std::size_t>(d)]) continue;
    distance = std::min(distance, x[d] - low_[d]);
    if (d != 1 || !open_top_) distance = std::min(distance, high_[d] - x[d]);
  }
  return distance;
}

template <int dim>
bool TankShape<dim>::left(const Vector<dim>& x) const {
  // Water that rises between the walls falls back between them. To rise 3H needs the speed √(2g 3H), which is
  // more than √(2gH), the speed of a column of height H.
  const double height = 3 * (high_[1] - low_[1]);
  if (!edges_.empty()) {
    const Nearest near = nearest(x, false);
    return !near.inside && !(near.distance <= (edges_[near.edge].wall ? spacing_ : height));
  }
  for (int d = 0; d < dim; ++d) {
    if (periodic_[static_cast<std::size_t>(d)]) continue;
    const double margin = d == 1 && open_top_ ? height : spacing_;
    if (!(x[d] >= low_[d] - spacing_ && x[d] <= high_[d] + margin)) return true;
  }
  return false;
}

template <int dim>
auto TankShape<dim>::behind(const Vector<dim>& x) const -> std::optional<WallFoot<dim>> {
  if (!edges_.empty()) {
    if constexpr (dim == 2) {
      if (distance(x) >= 0) return {};
      const Edge& edge = edges_[nearest(x, true).edge];
      const double along = std::clamp((x - edge.from).dot(edge.along), 0.0, edge.length);
      const Vector2 foot = edge.from + along * edge.along;
      // A place beyond the end of a wall at the rim is not behind that wall.
      if ((x - foot).dot(edge.normal) >= 0) return {};
      return WallFoot<dim>{foot, edge.normal};
    }
    return {};
  }
  if (open_top_ && x[1] > high_[1]) return {};
  for (int d = 0; d < dim; ++d) {
    if (periodic_[static_cast<std::size_t>(d)]) continue;
    const bool low = x[d]<low_[d], high = x[d]> high_[d] && (d != 1 || !open_top_);
    if (!low && !high) continue;
    WallFoot<dim> foot{x, Vector<dim>::Zero()};
    foot.position[d] = low ? low_[d] : high_[d];
    foot.normal[d] = low ? 1 : -1;
    return foot;
  }
  return {};
}

template <int dim>
double TankShape<dim>::volume() const {
  if (edges_.empty()) return open_top_ ? infinity : (high_ - low_).prod();
  double twice = 0;
  for (const Edge& edge : edges_) {
    if (!edge.wall) return infinity;
    twice += edge.from.x() * edge.to.y() - edge.from.y() * edge.to.x();
  }
  return 0.5 * twice;
}

template <int dim>
bool TankShape<dim>::on_lattice() const {
  return std::all_of(edges_.begin(), edges_.end(), [](const Edge& e) { return !e.wall || e.on_lattice; });
}

template <int dim>
double TankShape<dim>::distance_to_slanted(const Vector<dim>& x) const {
  double distance = infinity;
  if constexpr (dim == 2) {
    for (const Edge& edge : edges_)
      if (edge.wall && !edge.on_lattice)
        distance = std::min(distance, distance_to_segment(x, edge.from, edge.to));
  }
  return distance;
}

template <int dim>
std::optional<std::size_t> TankShape<dim>::slanted_edge_at(const Vector<dim>& x) const {
  if constexpr (dim == 2) {
    for (std::size_t e = 0; e < edges_.size(); ++e)
      if (edges_[e].wall && !edges_[e].on_lattice &&
          distance_to_segment(x, edges_[e].from, edges_[e].to) < lattice_tolerance * spacing_)
        return e;
  }
  return {};
}

template class TankShape<2>;
template class TankShape<3>;

}  // namespace strake::fluid
