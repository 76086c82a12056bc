#include "fluid/viscosity/viscous_walls.hpp"

#include "fluid/particles/pair_loop.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace strake::fluid {

using std::size_t;

template <int dim>
void WallLayers<dim>::resize(std::int64_t first_row, std::int64_t rows) {
  first = first_row;
  normal.setZero(dim, rows);
  velocity.setZero(dim, rows);
  depth.setZero(rows);
  master.assign(static_cast<size_t>(rows), -1);
  slip.assign(static_cast<size_t>(rows), 0);
}

template <int dim>
void describe_layers(const Boundary<dim>& boundary, const State<dim>& state, bool slip, double spacing,
                     WallLayers<dim>& walls) {
  const std::int64_t water = boundary.water(), rows = state.position.cols() - water;
  const Tank<dim>& tank = boundary.tank();
  const bool fresh = walls.first != water || walls.size() != rows;
  if (fresh) {
    walls.resize(water, rows);
    for (std::int64_t k = 0; k < rows; ++k) {
      walls.master[static_cast<size_t>(k)] = boundary.master_of(water + k);
      walls.depth[k] = 0.5 * spacing;
    }
    walls.slip.assign(static_cast<size_t>(rows), slip ? 1 : 0);
  }
  const std::int64_t bodies = boundary.first_of_bodies() - water;
#pragma omp parallel for schedule(static)
  for (std::int64_t k = fresh || tank.moves() ? 0 : bodies; k < rows; ++k) {
    const std::int64_t i = water + k, master = walls.master[static_cast<size_t>(k)];
    const std::int64_t front = master < 0 ? i : master;
    if (i < boundary.first_of_bodies()) {
      const Vector<dim> normal = boundary.normal_of(front);
      walls.normal.col(k) = normal;
      walls.depth[k] = 0.5 * spacing + normal.dot(state.position.col(front) - state.position.col(i));
      walls.velocity.col(k) = tank.moves() ? tank.velocity_at(state.position.col(i) + walls.depth[k] * normal)
                                           : Vector<dim>(state.velocity.col(i));
    } else if (boundary.volume()) {
      walls.slip[static_cast<size_t>(k)] = 0;
      walls.velocity.col(k) = state.velocity.col(i);
    } else {
      const int point = boundary.point_of(i);
      walls.normal.col(k) = boundary.body_surface().normal(point);
      walls.depth[k] =
          0.5 * spacing + walls.normal.col(k).dot(state.position.col(front) - state.position.col(i));
      walls.velocity.col(k) = boundary.body_surface().velocity(point);
    }
  }
}

template <int dim>
void VelocityBehind<dim>::extend(const ViscousFlow<dim>& flow, double radius,
                                 const std::optional<WallLaw>& law) {
  const WallLayers<dim>& walls = flow.walls;
  const std::int64_t rows = walls.size();
  assert(walls.first + rows == flow.position.cols());
  velocity.resize(dim, rows);
  slope.resize(dim, rows);
  mean.resize(dim, rows);
  distance_.setZero(rows);
  weight_.setZero(rows);
  slip = walls.slip;
  friction.resize(dim, 0);
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < rows; ++k) {
    if (walls.master[static_cast<size_t>(k)] >= 0) continue;
    const std::int64_t row = walls.first + k;
    const auto columns = flow.near.row(row);
    const auto inverses = flow.near.inverses(row);
    const Vector<dim> at = flow.position.col(row), face = walls.velocity.col(k), normal = walls.normal.col(k);
    Vector<dim> rise = Vector<dim>::Zero(), sum = Vector<dim>::Zero();
    double run = 0, weight = 0, distance = 0;
    for (size_t e = 0; e < columns.size() && columns[e] < walls.first; ++e) {
      const double w = radius * inverses[e] - 1;
      if (w <= 0) continue;
      const Vector<dim> r = flow.periodic.separation(at, flow.position.col(columns[e]));
      // Water that was put back onto the face has no height from which a slope follows. Half the depth is
      // used.
      const double d = std::max(0.5 * walls.depth[k], r.dot(normal) - walls.depth[k]);
      const Vector<dim> u = flow.velocity.col(columns[e]) - face;
      rise += w * d * u;
      run += w * d * d;
      sum += w * u;
      weight += w;
      distance += w * d;
    }
    slope.col(k) = run > 0 ? Vector<dim>(rise / run) : Vector<dim>(Vector<dim>::Zero());
    mean.col(k) = weight > 0 ? Vector<dim>(sum / weight) : Vector<dim>(Vector<dim>::Zero());
    weight_[k] = weight;
    distance_[k] = weight > 0 ? distance / weight : 0;
  }
  if (law) find_friction(flow, radius, *law);
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < rows; ++k) {
    velocity.col(k) = walls.velocity.col(k);
    if (flow.dry(walls.first + k)) continue;
    const std::int32_t master = walls.master[static_cast<size_t>(k)];
    const std::int64_t front = master < 0 ? k : master - walls.first;
    const Vector<dim> normal = walls.normal.col(front), rise = walls.depth[k] * slope.col(front);
    const bool corner = normal.squaredNorm() == 0;
    if (!slip[static_cast<size_t>(k)]) {
      if (!corner) velocity.col(k) -= rise;
    } else if (corner) {
      velocity.col(k) -= mean.col(front);
    } else {
      velocity.col(k) += mean.col(front) - normal * normal.dot(mean.col(front) + rise);
    }
  }
}

// Computes u_τ from the water's mean velocity along the face and its mean distance (F75). The layers behind a
// face that has friction are those of a smooth face.
template <int dim>
void VelocityBehind<dim>::find_friction(const ViscousFlow<dim>& flow, double radius, const WallLaw& law) {
  const WallLayers<dim>& walls = flow.walls;
  const std::int64_t rows = walls.size();
  friction.setZero(dim, rows);
  // Σ w of water on a lattice whose first row is l0/2 from the face: one particle l0 off, 2(d − 1) at √2 l0,
  // …
  const auto weight_at = [&](double r) { return std::max(0.0, radius / (r * law.spacing) - 1); };
  const double covered =
      dim == 2 ? weight_at(1) + 2 * weight_at(std::sqrt(2.0)) + weight_at(2)
               : weight_at(1) + 4 * weight_at(std::sqrt(2.0)) + 4 * weight_at(std::sqrt(3.0)) + weight_at(2);
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < rows; ++k) {
    const auto at = static_cast<size_t>(k);
    const Vector<dim> normal = walls.normal.col(k);
    if (walls.master[at] >= 0 || walls.slip[at] || weight_[k] <= 0 || normal.squaredNorm() == 0 ||
        flow.dry(walls.first + k))
      continue;
    const Vector<dim> along = mean.col(k) - normal * normal.dot(mean.col(k));
    const double speed = along.norm();
    const double u_tau = law.friction_velocity(speed, distance_[k]);
    if (u_tau * distance_[k] <= viscous_sublayer * law.kinematic_viscosity && law.kinematic_viscosity > 0)
      continue;
    slip[at] = 1;
    if (speed > 0)
      friction.col(k) = -u_tau * u_tau / (law.spacing * std::max(weight_[k], covered) * speed) * along;
  }
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < rows; ++k)
    if (const std::int32_t master = walls.master[static_cast<size_t>(k)]; master >= 0)
      slip[static_cast<size_t>(k)] = slip[static_cast<size_t>(master - walls.first)];
}

// a_i = Σ_k w_ik f_k, f = τ/(l0 Σ w) of the first layers (F76).
template <int dim>
void VelocityBehind<dim>::add_friction(const ViscousFlow<dim>& flow, double radius,
                                       Vectors<dim>& acceleration) const {
  if (friction.cols() == 0) return;
  const std::int64_t water = flow.walls.first;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < flow.position.cols(); ++i) {
    const bool layer = i >= water;
    if (!layer && !flow.ranks.owns(i)) continue;
    const auto columns = flow.near.row(i);
    const auto inverses = flow.near.inverses(i);
    const size_t inner = water_pairs(columns, water);
    const size_t first = layer ? 0 : inner, last = layer ? inner : columns.size();
    Vector<dim> sum = Vector<dim>::Zero();
    for (size_t e = first; e < last; ++e)
      if (const double w = radius * inverses[e] - 1; w > 0)
        sum += w * friction.col((layer ? i : columns[e]) - water);
    acceleration.col(i) += layer ? Vector<dim>(-sum) : sum;
  }
}

template struct WallLayers<2>;
template void describe_layers<2>(const Boundary<2>&, const State<2>&, bool, double, WallLayers<2>&);
template struct VelocityBehind<2>;
template struct WallLayers<3>;
template void describe_layers<3>(const Boundary<3>&, const State<3>&, bool, double, WallLayers<3>&);
template struct VelocityBehind<3>;

}  // namespace strake::fluid
