#include "fluid/simulation/simulation.hpp"

#include "fluid/simulation/step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::fluid {

double column_step(const Parameters& p) {
  return column_step(p, p.gravity.norm());
}

double column_step(const Parameters& p, double field) {
  // Least-squares does not push particles apart. The step is 1/71 of 2π √(l0/(π g)), the period of the
  // shortest wave.
  if (p.scheme.gradient == Gradient::least_squares) return 0.05 * std::sqrt(p.spacing / field);
  const double depth = p.water.max[1] - p.water.min[1];
  return 0.25 * p.spacing / (2 * std::sqrt(field * depth));
}

double acoustic_step(const Parameters& p) {
  return p.scheme.acoustic_cfl > 0 && std::isfinite(p.sound_speed)
             ? p.scheme.acoustic_cfl * p.spacing / p.sound_speed
             : std::numeric_limits<double>::infinity();
}

template <int dim>
Simulation<dim>::Simulation(const Parameters& p, const InterfaceMesh& partner, const Points& initial_velocity,
                            const Ranks& ranks)
    : work_(std::make_unique<Work>(p, partner, initial_velocity, ranks)) {}

template <int dim>
Simulation<dim>::~Simulation() = default;

template <int dim>
StepReport Simulation<dim>::step(double dt, const InterfaceMotion& motion, double rest) {
  Work& w = *work_;
  w.begin(dt, rest, rest > 0 && w.step.substepping.is_over() ? stable_dt() : 0, motion);
  if (w.step.substepping.begins()) w.measure();  // neighbours; ν∇²u + ∇·τ; free surface
  w.advance_air();                               // pressure on the surface under a body
  w.scheme->predict(w.step);                     // u* = u + Δt (ν∇²u + ∇·τ + g)
  w.solve_pressure();                            // ∇²p − p/(cΔt)² = ρ/Δt ∇·u* + …
  w.correct();                                   // load; u = u* − Δt/ρ ∇p; x += Δt u
  w.shift();                                     // towards even spacing; collision guard
  w.finish();                                    // accounts
  return w.report;
}

template <int dim>
const Points& Simulation<dim>::interface_force() const {
  return work_->force;
}

template <int dim>
const InterfaceMesh& Simulation<dim>::interface() const {
  return work_->step.boundary.mesh();
}

/// Returns the smallest limit of convection, gravity, viscosity and the column's weight (fluid/THEORY.md
/// (F63)). In the MPS schemes particles under a pressure ρgH push one another apart at the rate √(gH)/l0. A
/// step is therefore 0.25 l0 over the speed 2√(gH). Measured on a still tank, H = 0.5 m, l0 = 0.01 m: at
/// 0.11 l0/√(gH) the water stays at rest, at 0.22 it scatters. With least-squares the limit is 0.05 √(l0/g).
/// Sound sets no limit.
template <int dim>
double Simulation<dim>::stable_dt() const {
  const Work& w = *work_;
  const double l0 = w.step.p.spacing;
  double square = 0, energy = 0;
#pragma omp parallel for schedule(static) reduction(max : square, energy)
  for (Eigen::Index i = 0; i < w.step.state.velocity.cols(); ++i) {
    square = std::max(square, w.step.state.velocity.col(i).squaredNorm());
    if (w.step.ranks.owns(i)) energy = std::max(energy, w.step.state.sps_k[i]);  // ghosts lack neighbours
  }
  square = w.step.ranks.max(square);
  energy = w.step.ranks.max(energy);
  const double fastest = std::sqrt(square);
  double dt = std::numeric_limits<double>::infinity();
  if (fastest > 0) dt = std::min(dt, w.step.p.scheme.cfl * l0 / fastest);
  const double field =
      (w.step.p.gravity.template head<dim>() - w.step.boundary.tank().acceleration_of_frame()).norm();
  if (field > 0) dt = std::min(dt, 0.25 * std::sqrt(l0 / field));
  dt = std::min(dt, column_step(w.step.p, field));
  dt = std::min(dt, viscous_limit(w.step.p, energy));
  return dt;
}

template <int dim>
const State<dim>& Simulation<dim>::state() const {
  return work_->step.state;
}

template <int dim>
void Simulation<dim>::set_state(const State<dim>& state) {
  Work& w = *work_;
  w.step.state = state;
  if (w.step.subdomain)
    w.take_part();
  else
    w.forget_ranks();
  w.begin_again();
}

template <int dim>
auto Simulation<dim>::snapshot() const -> Snapshot {
  const Work& w = *work_;
  return {w.step.state, w.step.subdomain ? w.step.subdomain->shared_division() : nullptr};
}

template <int dim>
void Simulation<dim>::restore(const Snapshot& snapshot) {
  Work& w = *work_;
  w.step.state = snapshot.state;
  if (w.step.subdomain) {
    w.step.subdomain->adopt(snapshot.division, snapshot.state);
    w.count_particles();
  }
  w.begin_again();
}

template <int dim>
State<dim> Simulation<dim>::whole() const {
  const Work& w = *work_;
  return w.step.subdomain ? w.step.subdomain->join(w.step.state, w.step.subdomain->division()) : w.step.state;
}

template <int dim>
State<dim> Simulation<dim>::share_of(const Snapshot& snapshot) const {
  return work_->step.subdomain->share(snapshot.state, *snapshot.division);
}

template <int dim>
void Simulation<dim>::set_share(State<dim> share) {
  Work& w = *work_;
  w.step.state = std::move(share);
  w.step.subdomain->take_share(w.step.state);
  w.count_particles();
  w.begin_again();
}

template <int dim>
std::int64_t Simulation<dim>::particles() const {
  const Work& w = *work_;
  return w.step.subdomain ? w.step.subdomain->water_of_whole() + w.step.subdomain->layers_of_whole()
                          : w.step.state.position.cols();
}

template <int dim>
bool Simulation<dim>::is_removed(const State<dim>& state, std::int64_t i) const {
  return state.kind[static_cast<std::size_t>(i)] == Kind::fluid &&
         work_->step.boundary.tank().is_removed(state.position.col(i));
}

template <int dim>
const RankExchange<dim>& Simulation<dim>::ranks() const {
  return work_->step.ranks;
}

template <int dim>
const std::map<std::string, double>& Simulation<dim>::seconds() const {
  return work_->step.seconds;
}

template <int dim>
double Simulation<dim>::sensor_pressure(const Eigen::Vector3d& at, double diameter) const {
  const Work& w = *work_;
  const double reach = 0.5 * diameter * (1 + 1e-9);
  const auto covers = [&](const Eigen::Vector3d& x) { return (x - at).norm() <= reach; };
  double load = 0, area = 0;
  const BodySurface<dim>& body = w.step.boundary.body_surface();
  for (int k = 0; k < body.points(); ++k) {
    if (!covers(body.reference(k))) continue;
    load -= w.on_points.col(k).dot(body.normal(k));
    area += body.area(k);
  }
  if (w.step.boundary.volume()) {  // no faces: the mean over the structure's particles
    for (Eigen::Index k = 0; k < w.on_solids.cols(); ++k) {
      if (!covers(w.step.boundary.mesh().position.col(k))) continue;
      load += w.on_solids(0, k);
      area += w.on_solids(1, k);
    }
  }
  if (area > 0) return load / area;
  if (w.step.ranks.sum(w.on_walls.cols()) == 0) return 0;  // no step yet
  const auto [on_wall, of_wall] = w.load_on_walls(at, reach);
  return of_wall > 0 ? on_wall / of_wall : 0.0;
}

template <int dim>
Eigen::Vector3d Simulation<dim>::floor_force() const {
  Eigen::Vector3d floor = Eigen::Vector3d::Zero();
  floor.head<dim>() = work_->floor;
  return floor;
}

template <int dim>
std::vector<FacePiece> Simulation<dim>::face_pieces() const {
  const Work& w = *work_;
  const Boundary<dim>& boundary = w.step.boundary;
  const BodySurface<dim>& body = boundary.body_surface();
  std::vector<FacePiece> pieces(static_cast<std::size_t>(body.points()));
  for (int k = 0; k < body.points(); ++k) {
    FacePiece& piece = pieces[static_cast<std::size_t>(k)];
    piece.at.template head<dim>() = body.point(k);
    piece.normal.template head<dim>() = body.normal(k);
    piece.velocity.template head<dim>() = body.velocity(k);
    piece.area = body.area(k);
    piece.on_wall = std::abs(boundary.tank().distance(body.point(k))) < w.step.p.spacing;
    piece.pressure = -w.on_points.col(k).dot(body.normal(k)) / piece.area;
  }
  const State<dim>& state = w.step.state;
  for (std::int64_t i = boundary.first_of_bodies(); i < static_cast<std::int64_t>(state.kind.size()); ++i) {
    const auto row = static_cast<std::size_t>(i);
    const int point = boundary.point_of(i);
    if (state.kind[row] == Kind::interface && point >= 0 && state.surface[row] == 0)
      pieces[static_cast<std::size_t>(point)].wet = true;
  }
  return pieces;
}

template <int dim>
Extreme Simulation<dim>::highest_pressure() const {
  const Work& w = *work_;
  const BodySurface<dim>& body = w.step.boundary.body_surface();
  Extreme highest;
  for (int k = 0; k < body.points(); ++k) {
    const double pressure = -w.on_points.col(k).dot(body.normal(k)) / body.area(k);
    if (!(pressure > highest.value)) continue;
    highest.value = pressure;
    highest.at.template head<dim>() = body.point(k);
  }
  return highest;
}

template <int dim>
double Simulation<dim>::air_mass() const {
  return work_->air ? work_->air->mass(work_->step.state.air_mass) : 0;
}

template <int dim>
double Simulation<dim>::air_energy() const {
  return work_->air ? work_->air->energy(work_->step.state) : 0;
}

template <int dim>
auto Simulation<dim>::air_extent() const -> AirExtent {
  if (!work_->air) return {};
  const auto [columns, area, half_width] = work_->air->extent();
  return {columns, area, half_width};
}

template <int dim>
auto Simulation<dim>::air_on_faces() const -> AirOnFaces {
  const State<dim>& state = work_->step.state;
  if (!work_->air) return {};
  AirOnFaces faces{Eigen::VectorXd::Zero(state.position.cols()),
                   Eigen::VectorXd::Zero(state.position.cols())};
  work_->air->for_each_row(state, [&](std::int64_t row, double gap, double pressure) {
    faces.gap[row] = gap;
    faces.pressure[row] = pressure;
  });
  return faces;
}

template <int dim>
auto Simulation<dim>::air_at(const Eigen::Vector3d& reference) const -> AirAt {
  const Work& w = *work_;
  if (!w.air) return {};
  const auto [column, distance] = w.air->column_at(w.step.boundary.body_surface(), reference);
  if (!(w.step.state.air_mass[column] > 0)) return {0, 0, distance};
  return {w.step.state.air_gap[column], w.step.state.air_pressure[column], distance};
}

template <int dim>
Extreme Simulation<dim>::fastest() const {
  const Work& w = *work_;
  double square = 0;
  std::int64_t place = -1;
  for (std::int64_t i = 0; i < w.step.boundary.water(); ++i) {
    const double of_particle = w.step.state.velocity.col(i).squaredNorm();
    if (!(of_particle > square) || !w.step.ranks.owns(i)) continue;
    square = of_particle;
    place = i;
  }
  Extreme fastest{.value = std::sqrt(square)};
  if (place >= 0) fastest.at.template head<dim>() = w.step.state.position.col(place);
  return w.step.subdomain ? w.largest_of_ranks(fastest, place) : fastest;
}

template class Simulation<2>;
template class Simulation<3>;

}  // namespace strake::fluid
