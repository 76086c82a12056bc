#include "fluid/air/air_under_body.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace strake::fluid {
namespace {

constexpr double looks_down = 0.5;  // −n_y of a face from which on it has air under it; 60° against the level
constexpr double at_film = 2;       // [ρ0 δ] air of a column that has lost its own
constexpr double disorder = 0.2;      // [l0] by which water in contact may be lower than its surface
constexpr double follow_time = 0.01;  // [s] in which the surface comes back to the water's particles

}  // namespace

template <int dim>
AirUnderBody<dim>::AirUnderBody(const AirKeys& keys, StepData<dim>& step) : keys_(keys) {
  find_columns(step);
  step.air.aired.assign(static_cast<std::size_t>(step.boundary.body_surface().points()), 0);
  if (step.state.air_mass.size() == 0) begin(step);
  mark(step);
}

// The body is walked counter-clockwise, so that its lower faces come in the order of x.
template <int dim>
void AirUnderBody<dim>::find_columns(const StepData<dim>& step) {
  const BodySurface<dim>& body = step.boundary.body_surface();
  const int n = body.points();
  const auto down = [&](int k) { return -body.normal(k)[1] > looks_down; };
  int first = 0;
  while (first < n && !(down(first) && !down((first + n - 1) % n))) ++first;
  if (first == n)
    throw Error(
        ExitCode::case_file, "fluid.air.layer = true",
        "the body has no lower face with an end: air is computed under plates, boxes and other bodies "
        "whose faces look down",
        "fluid.air.layer = false");
  for (int k = first; down(k); k = (k + 1) % n) point_.push_back(k);
  const auto columns = static_cast<Eigen::Index>(point_.size());
  Eigen::VectorXd middle(columns), width(columns);
  for (Eigen::Index c = 0; c < columns; ++c) {
    const int k = point_[static_cast<std::size_t>(c)];
    middle[c] = body.point(k)[0];
    width[c] = -body.normal(k)[1] * body.area(k);
  }
  row_.assign(point_.size(), -1);
  for (std::int64_t j = step.boundary.first_of_bodies(); j < step.state.position.cols(); ++j) {
    if (step.boundary.master_of(j) >= 0) continue;
    const auto found = std::find(point_.begin(), point_.end(), step.boundary.point_of(j));
    if (found != point_.end()) row_[static_cast<std::size_t>(found - point_.begin())] = j;
  }
  if constexpr (plane == 1) layer_.emplace_back(AirProperties(keys_), air_strip(middle, width));
}

template <int dim>
void AirUnderBody<dim>::begin(StepData<dim>& step) {
  State<dim>& state = step.state;
  const BodySurface<dim>& body = step.boundary.body_surface();
  const auto n = static_cast<Eigen::Index>(point_.size());
  Eigen::VectorXd gap(n), speed(n);
  state.air_surface.setConstant(n, step.p.water.max.y());
  for (Eigen::Index c = 0; c < n; ++c) {
    const int k = point_[static_cast<std::size_t>(c)];
    gap[c] = body.point(k)[1] - state.air_surface[c];
    speed[c] = std::max(0.0, -body.velocity(k)[1]);
    if (!(gap[c] > keys_.film))
      throw Error(ExitCode::case_file, "fluid.air.layer = true",
                  fmt::format("the body's lower face starts {:.4g} m under the water's level at x = {:.4g} m",
                              -gap[c], body.point(k)[0]),
                  "start the body above the water, or fluid.air.layer = false");
  }
  store(layer_.front().start(gap, speed), state);
  state.air_pressure = layer_.front().pressure(air_of(state)).array() - keys_.pressure;
  state.air_at_start = mass(state.air_mass);
}

template <int dim>
AirState<AirUnderBody<dim>::plane> AirUnderBody<dim>::air_of(const State<dim>& state) const {
  AirState<plane> air;
  air.mass = state.air_mass;
  air.momentum = Eigen::Map<const Eigen::Matrix<double, plane, Eigen::Dynamic>>(state.air_momentum.data(),
                                                                                plane, state.air_mass.size());
  air.gap = state.air_gap;
  air.mass_out = state.air_out;
  air.vents.resize(row_.size());
  for (std::size_t c = 0; c < row_.size(); ++c)
    air.vents[c] = state.surface[static_cast<std::size_t>(row_[c])];  // a dry face
  return air;
}

template <int dim>
void AirUnderBody<dim>::store(const AirState<plane>& air, State<dim>& state) const {
  state.air_mass = air.mass;
  state.air_momentum = Eigen::Map<const Eigen::VectorXd>(air.momentum.data(), air.momentum.size());
  state.air_gap = air.gap;
  state.air_out = air.mass_out;
}

// The first row is the highest water under the face within a spacing, and what is less than 0.7 l0 lower.
// Weights fall linearly to both.
template <int dim>
auto AirUnderBody<dim>::sample(const StepData<dim>& step) const -> Sample {
  const State<dim>& state = step.state;
  const BodySurface<dim>& body = step.boundary.body_surface();
  const auto n = static_cast<Eigen::Index>(point_.size());
  const double l0 = step.p.spacing;
  const double left = body.point(point_.front())[0] - l0, right = body.point(point_.back())[0] + l0;
  Eigen::VectorXd top = state.air_surface.array() - 2 * l0;
  const double low = top.minCoeff() - 2 * l0;
  struct Near {
    Eigen::Index column;
    std::int64_t particle;
    double aside;
  };
  std::vector<Near> near;
  for (std::int64_t i = 0; i < step.boundary.water(); ++i) {
    const double x = state.position(0, i), y = state.position(1, i);
    if (y < low || x < left || x > right) continue;
    const auto from = static_cast<Eigen::Index>(std::floor(column_at(step, x))) - 1;
    for (Eigen::Index c = std::max<Eigen::Index>(0, from); c < std::min(n, from + 4); ++c) {
      const Vector<dim> face = body.point(point_[static_cast<std::size_t>(c)]);
      const double aside = std::abs(x - face[0]) / l0;
      if (aside >= 1 || y > face[1]) continue;
      near.push_back({c, i, aside});
      top[c] = std::max(top[c], y);
    }
  }
  Sample out{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n),
             Eigen::VectorXd::Zero(n)};
  for (const auto& [c, i, aside] : near) {
    const double w = (1 - aside) * (1 - (top[c] - state.position(1, i)) / (0.7 * l0));
    if (!(w > 0)) continue;
    out.weight[c] += w;
    out.velocity[c] += w * state.velocity(1, i);
    out.pressure[c] += w * state.pressure[i];
    out.level[c] += w * (state.position(1, i) + 0.5 * l0);
  }
  for (Eigen::Index c = 0; c < n; ++c) {
    if (!(out.weight[c] > 0)) continue;
    for (Eigen::VectorXd* mean : {&out.velocity, &out.pressure, &out.level}) (*mean)[c] /= out.weight[c];
  }
  return out;
}

/// The number of the column at x, with a fraction: 2.5 is the middle between columns 2 and 3.
template <int dim>
double AirUnderBody<dim>::column_at(const StepData<dim>& step, double x) const {
  const BodySurface<dim>& body = step.boundary.body_surface();
  const auto place = [&](std::size_t c) { return body.point(point_[c])[0]; };
  const std::size_t n = point_.size();
  std::size_t low = 0, high = n - 1;
  if (n == 1 || x <= place(0)) return x < place(0) ? -1 : 0;
  if (x >= place(high)) return static_cast<double>(high);
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (place(middle) <= x ? low : high) = middle;
  }
  return static_cast<double>(low) + (x - place(low)) / (place(high) - place(low));
}

template <int dim>
void AirUnderBody<dim>::give_over(StepData<dim>& step) {
  State<dim>& state = step.state;
  const double least = keys_.density * keys_.film;
  const double compliance = step.dt * step.dt / (step.p.density * 0.5 * step.p.spacing);
  for (std::size_t c = 0; c < point_.size(); ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    const double area = layer_.front().columns().area[i];
    if (!(state.air_mass[i] > 0 && state.air_pressure[i] > 0)) continue;
    const bool stiff = keys_.gamma * (keys_.pressure + state.air_pressure[i]) * compliance > state.air_gap[i];
    if (!stiff && state.air_mass[i] > at_film * least) continue;
    state.air_out += area * state.air_mass[i];
    state.air_mass[i] = state.air_pressure[i] = 0;
    state.air_momentum.segment(plane * i, plane).setZero();
  }
  mark(step);
}

template <int dim>
void AirUnderBody<dim>::mark(StepData<dim>& step) const {
  for (std::size_t c = 0; c < point_.size(); ++c)
    step.air.aired[static_cast<std::size_t>(point_[c])] =
        step.state.air_mass[static_cast<Eigen::Index>(c)] > 0;
}

template <int dim>
void AirUnderBody<dim>::advance(StepData<dim>& step) {
  State<dim>& state = step.state;
  const BodySurface<dim>& body = step.boundary.body_surface();
  const auto n = static_cast<Eigen::Index>(point_.size());
  const double l0 = step.p.spacing, dt = step.dt, rho = step.p.density;
  AirState<plane> air = air_of(state);
  layer_.front().advance(air, air.gap, dt);

  // The surface meets the air: w' = w + Δt ((p_water − p)/(ρ d) + g), d = l0/2 down to the first row.
  const Sample water = sample(step);
  const double depth = 0.5 * l0, compliance = dt * dt / (rho * depth);
  for (Eigen::Index c = 0; c < n; ++c) {
    if (!(air.mass[c] > 0)) continue;
    const int k = point_[static_cast<std::size_t>(c)];
    const double face = body.point(k)[1] + (step.substepping.age() + dt) * body.velocity(k)[1];
    double rise = 0;  // of the surface in the step, with p0 on it
    if (water.weight[c] > 0) {
      // A thin gap opens to the water's particles and is never closed by their disorder.
      const double lacking = water.level[c] - state.air_surface[c];
      const double share = lacking < -disorder * l0 ? 1 : std::clamp(air.gap[c] / l0 - 0.25, 0.0, 1.0);
      rise = share * std::min(1.0, dt / follow_time) * lacking +
             dt * (water.velocity[c] + dt * (water.pressure[c] / (rho * depth) + step.gravity[1]));
    }
    const double free_gap = face - state.air_surface[c] - rise;
    air.gap[c] = layer_.front().air().gap_of(air.mass[c], free_gap, compliance);
    state.air_surface[c] = face - air.gap[c];
  }
  store(air, state);
  state.air_pressure = layer_.front().pressure(air).array() - keys_.pressure;
  press_surface(step);
}

// Linear between the middles of columns. Towards the border the pressure falls to that of the open air.
template <int dim>
void AirUnderBody<dim>::press_surface(StepData<dim>& step) const {
  const State<dim>& state = step.state;
  const BodySurface<dim>& body = step.boundary.body_surface();
  const auto n = static_cast<Eigen::Index>(point_.size());
  const double l0 = step.p.spacing;
  step.air.pressure.setZero(step.boundary.water());
  const double left = body.point(point_.front())[0] - 0.5 * l0,
               right = body.point(point_.back())[0] + 0.5 * l0;
  for (std::int64_t i = 0; i < step.boundary.water(); ++i) {
    const double x = state.position(0, i);
    if (x <= left || x >= right) continue;
    const double at = std::max(0.0, column_at(step, x));
    const auto c = std::min(n - 1, static_cast<Eigen::Index>(at)), next = std::min(n - 1, c + 1);
    const double part = at - static_cast<double>(c);
    const auto between = [&](const Eigen::VectorXd& of) { return (1 - part) * of[c] + part * of[next]; };
    if (state.position(1, i) > between(state.air_surface) + l0) continue;  // over the body
    step.air.pressure[i] =
        between(state.air_pressure) * std::min(1.0, std::min(x - left, right - x) / (0.5 * l0));
  }
}

template <int dim>
void AirUnderBody<dim>::add_load(const StepData<dim>& step, Vectors<dim>& on_points) const {
  const BodySurface<dim>& body = step.boundary.body_surface();
  for (std::size_t c = 0; c < point_.size(); ++c)
    on_points.col(point_[c]) -=
        step.state.air_pressure[static_cast<Eigen::Index>(c)] * body.area(point_[c]) * body.normal(point_[c]);
}

template class AirUnderBody<2>;

}  // namespace strake::fluid
