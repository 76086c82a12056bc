#include "fluid/air/air_under_body.hpp"

#include "fluid/air/lower_faces.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::fluid {
namespace {

constexpr double at_film = 2;         // [ρ0 δ] air of a column that has lost its own
constexpr double disorder = 0.2;      // [l0] by which water in contact may be lower than its surface
constexpr double follow_time = 0.01;  // [s] in which the surface comes back to the water's particles
constexpr double deep = 4;            // [l0] below the surface no particle sees it

/// The water from the surface down to the first row.
struct HalfRow {
  template <int dim>
  explicit HalfRow(const StepData<dim>& step)
      : depth(0.5 * step.p.spacing),
        inertia(step.p.density * depth),
        elastic(depth / (step.p.density * step.p.sound_speed * step.p.sound_speed)) {}
  /// How far a pressure moves the surface in a step [m/Pa]: C of (F82).
  double compliance(double dt) const { return dt * dt / inertia + elastic; }

  double depth;    // d [m]
  double inertia;  // ρ d [kg/m²]
  double elastic;  // d/(ρ c²) [m/Pa]
};

}  // namespace

template <int dim>
AirUnderBody<dim>::AirUnderBody(const AirKeys& keys, StepData<dim>& step) : keys_(keys) {
  find_columns(step);
  step.air.aired.assign(static_cast<std::size_t>(step.boundary.body_surface().points()), 0);
  if (step.state.air_mass.size() == 0) begin(step);
  if (step.state.air_surface_velocity.size() == 0) step.state.air_surface_velocity.setZero(size());
  for (Eigen::Index i = 0; i < size(); ++i)
    if (step.state.air_mass[i] > 0) set_aired(i, step, 1);
}

template <int dim>
auto AirUnderBody<dim>::from_above(const Vector<dim>& x) -> Place {
  if constexpr (dim == 2)
    return Place(x[0]);
  else
    return Place(x[0], x[2]);
}

template <int dim>
void AirUnderBody<dim>::find_columns(const StepData<dim>& step) {
  const BodySurface<dim>& body = step.boundary.body_surface();
  std::vector<std::int64_t> row_behind(static_cast<std::size_t>(body.points()), -1);
  for (std::int64_t j = step.boundary.first_of_bodies(); j < step.state.position.cols(); ++j)
    if (step.boundary.master_of(j) < 0) row_behind[static_cast<std::size_t>(step.boundary.point_of(j))] = j;
  columns_over_.assign(static_cast<std::size_t>(body.points()), 0);
  for (AirField<plane>& field : lower_faces<dim>(step.boundary, step.p.spacing, keys_.columns)) {
    const auto first = columns_.size();
    for (std::size_t c = 0; c < field.points.size(); ++c) {
      Column column;
      Place mean = Place::Zero();
      for (const int k : field.points[c]) {
        column.points.push_back(k);
        column.rows.push_back(row_behind[static_cast<std::size_t>(k)]);
        ++columns_over_[static_cast<std::size_t>(k)];
        mean += from_above(body.point(k)) / static_cast<double>(field.points[c].size());
      }
      column.offset = field.columns.place.col(static_cast<Eigen::Index>(c)) - mean;
      columns_.push_back(std::move(column));
    }
    for (const auto& side : field.columns.sides) {
      if (side.other >= 0) continue;
      const Place middle = side.middle - field.columns.place.col(side.column);
      columns_[first + static_cast<std::size_t>(side.column)].borders.push_back(
          {middle, side.normal, side.length});
    }
    first_.push_back(static_cast<Eigen::Index>(columns_.size()));
    response_.emplace_back(field.columns, step.p.spacing, step.p.density);
    layer_.emplace_back(AirProperties(keys_), std::move(field.columns));
  }
  if (layer_.empty())
    throw Error(
        ExitCode::case_file, "fluid.air.layer = true",
        "the body has no lower face: air is computed under plates, boxes and other bodies whose faces "
        "look down",
        "fluid.air.layer = false");
  area_.resize(size());
  for (std::size_t f = 0; f < layer_.size(); ++f)
    area_.segment(first_of(f), count_of(f)) = layer_[f].columns().area;
}

template <int dim>
auto AirUnderBody<dim>::extent() const -> Extent {
  double largest = 0;
  for (std::size_t f = 0; f < layer_.size(); ++f) largest = std::max(largest, layer_[f].columns().area.sum());
  return {size(), area_.sum(), 0.5 * (plane == 1 ? largest : std::sqrt(largest))};
}

template <int dim>
auto AirUnderBody<dim>::column_at(const BodySurface<dim>& body, const Eigen::Vector3d& reference) const
    -> Found {
  Found found{-1, std::numeric_limits<double>::infinity()};
  for (Eigen::Index c = 0; c < size(); ++c)
    for (const int k : columns_[static_cast<std::size_t>(c)].points)
      if (const double distance = (body.reference(k) - reference).norm(); distance < found.distance)
        found = {c, distance};
  return found;
}

// A face is extended in its plane from each wet point to the middle of the column.
template <int dim>
auto AirUnderBody<dim>::faces(const StepData<dim>& step) const -> Faces {
  const BodySurface<dim>& body = step.boundary.body_surface();
  Faces out{{plane, size()}, Eigen::VectorXd::Zero(size()), Eigen::VectorXd::Zero(size())};
  for (Eigen::Index c = 0; c < size(); ++c) {
    const Column& column = columns_[static_cast<std::size_t>(c)];
    const double share = 1 / static_cast<double>(column.points.size());
    Place middle = column.offset;
    for (const int k : column.points) middle += share * from_above(body.point(k));
    out.place.col(c) = middle;
    for (const int k : column.points) {
      const Place slope = from_above(body.normal(k)) / body.normal(k)[1];
      out.height[c] += share * (body.point(k)[1] - slope.dot(middle - from_above(body.point(k))));
      out.speed[c] += share * body.velocity(k)[1];
    }
  }
  return out;
}

template <int dim>
void AirUnderBody<dim>::begin(StepData<dim>& step) {
  State<dim>& state = step.state;
  const Faces face = faces(step);
  state.air_surface.setConstant(size(), step.p.water.max.y());
  const Sample water = sample(step, face, near(face, step.p.spacing));
  const Eigen::VectorXd gap = face.height - state.air_surface,
                        closing = (water.velocity - face.speed).cwiseMax(0.0);
  Eigen::Index lowest = 0;
  if (!(gap.minCoeff(&lowest) > keys_.film))
    throw Error(ExitCode::case_file, "fluid.air.layer = true",
                fmt::format("the body's lower face starts {:.4g} m under the water's level at x = {:.4g} m",
                            -gap[lowest], face.place(0, lowest)),
                "start the body above the water, or fluid.air.layer = false");
  state.air_mass.resize(size());
  state.air_gap.resize(size());
  state.air_pressure.resize(size());
  state.air_momentum.resize(plane * size());
  for (std::size_t f = 0; f < layer_.size(); ++f) {
    const auto first = first_of(f), n = count_of(f);
    const AirState<plane> air = layer_[f].start(gap.segment(first, n), closing.segment(first, n));
    store(air, f, state);
    state.air_pressure.segment(first, n) = layer_[f].pressure(air).array() - keys_.pressure;
  }
  state.air_at_start = mass(state.air_mass);
  state.air_energy_due = state.air_energy_given = energy(state);
}

template <int dim>
auto AirUnderBody<dim>::air_of(const State<dim>& state, std::size_t layer) const -> AirState<plane> {
  const auto first = first_of(layer), n = count_of(layer);
  AirState<plane> air;
  air.mass = state.air_mass.segment(first, n);
  air.momentum = Eigen::Map<const Eigen::Matrix<double, plane, Eigen::Dynamic>>(
      state.air_momentum.data() + plane * first, plane, n);
  air.gap = state.air_gap.segment(first, n);
  const auto is_dry = [&](std::int64_t row) { return state.surface[static_cast<std::size_t>(row)] != 0; };
  for (Eigen::Index c = first; c < first + n; ++c) {
    const auto& rows = columns_[static_cast<std::size_t>(c)].rows;
    air.vents.push_back(std::all_of(rows.begin(), rows.end(), is_dry));
  }
  return air;
}

template <int dim>
void AirUnderBody<dim>::store(const AirState<plane>& air, std::size_t layer, State<dim>& state) const {
  const auto first = first_of(layer), n = count_of(layer);
  state.air_mass.segment(first, n) = air.mass;
  state.air_momentum.segment(plane * first, plane * n) =
      Eigen::Map<const Eigen::VectorXd>(air.momentum.data(), air.momentum.size());
  state.air_gap.segment(first, n) = air.gap;
  state.air_out += air.mass_out;
  state.air_energy_due -= air.energy_out;
}

template <int dim>
double AirUnderBody<dim>::energy(const State<dim>& state) const {
  double sum = 0;
  for (std::size_t f = 0; f < layer_.size(); ++f) sum += layer_[f].energy(air_of(state, f));
  return sum;
}

template <int dim>
auto AirUnderBody<dim>::near(const Faces& face, double spacing) const -> Near {
  Near all;
  for (std::size_t f = 0; f < layer_.size(); ++f)
    all.emplace_back(face.place.middleCols(first_of(f), count_of(f)), spacing);
  return all;
}

// The first row is the highest water under the face within a spacing, and what is less than 0.7 l0 lower.
// Weights fall linearly to both.
template <int dim>
auto AirUnderBody<dim>::sample(const StepData<dim>& step, const Faces& face, const Near& fields) const
    -> Sample {
  const State<dim>& state = step.state;
  const double l0 = step.p.spacing;
  Eigen::VectorXd top = state.air_surface.array() - 2 * l0;
  const double low = top.minCoeff() - 2 * l0, high = face.height.maxCoeff();
  struct Pair {
    Eigen::Index column;
    std::int64_t particle;
    double w;
  };
  std::vector<Pair> near;
  for (std::int64_t i = 0; i < step.boundary.water(); ++i) {
    const double y = state.position(1, i);
    if (y < low || y > high) continue;
    for (std::size_t f = 0; f < fields.size(); ++f)
      fields[f].for_each(from_above(state.position.col(i)), [&](int k, double w) {
        const Eigen::Index c = first_of(f) + k;
        if (y > face.height[c]) return;
        near.push_back({c, i, w});
        top[c] = std::max(top[c], y);
      });
  }
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(size());
  Sample out{none, none, none, none};
  for (const auto& [c, i, aside] : near) {
    const double w = aside * (1 - (top[c] - state.position(1, i)) / (0.7 * l0));
    if (!(w > 0)) continue;
    out.weight[c] += w;
    out.velocity[c] += w * state.velocity(1, i);
    out.pressure[c] += w * state.pressure[i];
    out.level[c] += w * (state.position(1, i) + 0.5 * l0);
  }
  for (Eigen::Index c = 0; c < size(); ++c) {
    if (!(out.weight[c] > 0)) continue;
    for (Eigen::VectorXd* mean : {&out.velocity, &out.pressure, &out.level}) (*mean)[c] /= out.weight[c];
  }
  return out;
}

// Columns under one wet point go together.
template <int dim>
void AirUnderBody<dim>::give_over(StepData<dim>& step) {
  State<dim>& state = step.state;
  const AirProperties air(keys_);
  const double least = keys_.density * keys_.film;
  const double compliance = HalfRow(step).compliance(step.dt);
  const auto keeps = [&](Eigen::Index i) {
    if (!(state.air_pressure[i] > 0)) return true;
    const bool stiff = keys_.gamma * (keys_.pressure + state.air_pressure[i]) * compliance > state.air_gap[i];
    return !stiff && state.air_mass[i] > at_film * least;
  };
  step.air.aired.assign(step.air.aired.size(), 0);
  for (Eigen::Index i = 0; i < size(); ++i)
    if (state.air_mass[i] > 0) set_aired(i, step, 1);
  for (Eigen::Index i = 0; i < size(); ++i)
    if (!(state.air_mass[i] > 0) || !keeps(i)) set_aired(i, step, 0);
  for (Eigen::Index i = 0; i < size(); ++i) {
    if (!(state.air_mass[i] > 0) || is_aired(i, step)) continue;
    state.air_out += area_[i] * state.air_mass[i];
    const auto momentum = state.air_momentum.segment(plane * i, plane);
    state.air_energy_due -= area_[i] * air.energy_of(state.air_mass[i], state.air_gap[i],
                                                     (momentum / state.air_mass[i]).squaredNorm());
    state.air_mass[i] = state.air_pressure[i] = 0;
    state.air_momentum.segment(plane * i, plane).setZero();
  }
}

template <int dim>
void AirUnderBody<dim>::set_aired(Eigen::Index column, StepData<dim>& step, std::uint8_t has) const {
  for (const int k : columns_[static_cast<std::size_t>(column)].points)
    step.air.aired[static_cast<std::size_t>(k)] = has;
}

template <int dim>
bool AirUnderBody<dim>::is_aired(Eigen::Index column, const StepData<dim>& step) const {
  const auto& points = columns_[static_cast<std::size_t>(column)].points;
  return std::any_of(points.begin(), points.end(),
                     [&](int k) { return step.air.aired[static_cast<std::size_t>(k)] != 0; });
}

template <int dim>
void AirUnderBody<dim>::advance(StepData<dim>& step) {
  State<dim>& state = step.state;
  const double l0 = step.p.spacing, dt = step.dt;
  const Faces face = faces(step);
  // The surface meets the air: w' = w + Δt ((p_water − p)/(ρ d) + g), d = l0/2 down to the first row. That
  // half row is pressed together by d (p − p_before)/(ρ c²).
  const Near fields = near(face, l0);
  const Sample water = sample(step, face, fields);
  const HalfRow row(step);
  const double compliance = row.compliance(dt);
  for (std::size_t f = 0; f < layer_.size(); ++f) {
    const auto first = first_of(f);
    AirState<plane> air = air_of(state, f);
    layer_[f].advance(air, air.gap, dt);
    for (Eigen::Index k = 0; k < count_of(f); ++k) {
      if (!(air.mass[k] > 0)) continue;
      const Eigen::Index c = first + k;
      const double height = face.height[c] + (step.substepping.age() + dt) * face.speed[c];
      double rise = 0;  // of the surface in the step, with p0 on it
      if (water.weight[c] > 0) {
        // A thin gap opens to the water's particles and is never closed by their disorder.
        const double lacking = water.level[c] - state.air_surface[c];
        if (lacking * state.air_surface_velocity[c] < 0 &&
            std::abs(lacking) > SurfaceResponse<plane>::steep * l0)
          state.air_surface_velocity[c] = 0;
        const double share = lacking < -disorder * l0 ? 1 : std::clamp(air.gap[k] / l0 - 0.25, 0.0, 1.0);
        rise = share * std::min(1.0, dt / follow_time) * lacking +
               dt * (water.velocity[c] + state.air_surface_velocity[c] +
                     dt * (water.pressure[c] / row.inertia + step.gravity[1]));
      }
      const double before = air.gap[k],
                   free_gap = height - state.air_surface[c] - rise - row.elastic * state.air_pressure[c];
      air.gap[k] = layer_[f].air().gap_of(air.mass[k], free_gap, compliance);
      // Face and surface do the work (p − p0) A (h − h').
      const double over = layer_[f].air().pressure_of(air.mass[k], air.gap[k]) - keys_.pressure;
      const double work = over * area_[c] * (before - air.gap[k]);
      state.air_energy_due += work;
      state.air_energy_given += std::max(0.0, work);
      state.air_surface[c] = height - air.gap[k];
    }
    store(air, f, state);
    state.air_pressure.segment(first, count_of(f)) = layer_[f].pressure(air).array() - keys_.pressure;
    let_surface_follow(f, air, step);
  }
  press_surface(step, face, fields);
}

template <int dim>
void AirUnderBody<dim>::let_surface_follow(std::size_t layer, const AirState<plane>& air,
                                           StepData<dim>& step) const {
  const auto first = first_of(layer), n = count_of(layer);
  auto velocity = step.state.air_surface_velocity.segment(first, n);
  velocity += step.dt * response_[layer].acceleration(layer_[layer].columns(), air,
                                                      step.state.air_pressure.segment(first, n));
  velocity = (air.mass.array() > 0).select(velocity, 0.0);  // a face in contact is met by the row itself
}

// Linear between the middles of columns of one field. Over the last l0/2 before an open border the pressure
// falls to that of the open air.
template <int dim>
void AirUnderBody<dim>::press_surface(StepData<dim>& step, const Faces& face, const Near& fields) const {
  const State<dim>& state = step.state;
  const double l0 = step.p.spacing;
  step.air.pressure.setZero(step.boundary.water());
  for (std::size_t f = 0; f < layer_.size(); ++f) {
    const auto first = first_of(f), n = count_of(f);
    const auto surface = state.air_surface.segment(first, n);
    const double low = surface.minCoeff() - deep * l0, high = surface.maxCoeff() + l0;
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < step.boundary.water(); ++i) {
      const double y = state.position(1, i);
      if (y < low || y > high) continue;
      const Place x = from_above(state.position.col(i));
      double weights = 0, pressure = 0, level = 0, inside = 0.5 * l0;
      fields[f].for_each(x, [&](int k, double w) {
        const Eigen::Index c = first + k;
        weights += w;
        pressure += w * state.air_pressure[c];
        level += w * state.air_surface[c];
        for (const Border& border : columns_[static_cast<std::size_t>(c)].borders) {
          const Place to = face.place.col(c) + border.middle - x;
          const double across = to.dot(border.normal);
          if ((to - across * border.normal).norm() <= 0.5 * (border.length + l0))
            inside = std::min(inside, across);
        }
      });
      if (!(weights > 0 && inside > 0) || y > level / weights + l0) continue;  // aside or over the body
      step.air.pressure[i] = pressure / weights * inside / (0.5 * l0);
    }
  }
}

template <int dim>
void AirUnderBody<dim>::add_load(const StepData<dim>& step, Vectors<dim>& on_points) const {
  const BodySurface<dim>& body = step.boundary.body_surface();
  for (std::size_t c = 0; c < columns_.size(); ++c)
    for (const int k : columns_[c].points)
      on_points.col(k) -= step.state.air_pressure[static_cast<Eigen::Index>(c)] /
                          columns_over_[static_cast<std::size_t>(k)] * body.area(k) * body.normal(k);
}

template class AirUnderBody<2>;
template class AirUnderBody<3>;

}  // namespace strake::fluid
