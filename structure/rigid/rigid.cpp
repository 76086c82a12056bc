#include "structure/rigid/rigid.hpp"

#include "structure/body/surface.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace strake::structure {
namespace {

constexpr double degree = std::numbers::pi / 180;  // [rad]

/// Turn as a vector along its axis [rad]; in the plane with whole turns counted.
Eigen::Vector3d turn_vector(const RigidState& state, int dimension) {
  if (dimension == 2) return {0, 0, state.angle};
  const Eigen::AngleAxisd turn(state.turn);
  return turn.angle() * turn.axis();
}

/// Added mass of a flat plate at the surface, as long and wide as the body seen from below. It is ½πρa² per
/// length, with a half the shorter side (fluid/THEORY.md (F64)). It estimates how hard the coupling must
/// iterate.
double plate_added_mass(const Parameters& p) {
  const Eigen::Vector3d size = bounds(p).max - bounds(p).min;
  if (p.dimension == 2) return 0.5 * std::numbers::pi * p.fluid_density * 0.25 * size.x() * size.x();
  const double side = std::min(size.x(), size.z()), length = std::max(size.x(), size.z());
  return 0.5 * std::numbers::pi * p.fluid_density * 0.25 * side * side * length;
}

std::string motion_text(const Parameters& p) {
  std::string moves;
  const std::array<std::pair<bool, const char*>, 5> free = {{{p.free.x, "x"},
                                                             {p.free.y, "y"},
                                                             {p.free.z, "z"},
                                                             {p.free.angle, "angle"},
                                                             {p.free.rotation, "rotation"}}};
  for (const auto& [is_free, name] : free)
    if (is_free) moves += (moves.empty() ? "free in " : ", ") + std::string(name);
  if (p.motion)
    moves += (moves.empty() ? "" : "   ") +
             fmt::format("driven by a table from {:.4g} to {:.4g} s", p.motion->start(), p.motion->end());
  const double by_table = p.motion ? p.motion->largest_speed(p.end_time) : 0;
  moves += (moves.empty() ? "" : "   ") +
           (by_table > 0 ? fmt::format("speed up to {:.4g} m/s", p.velocity.norm() + by_table)
                         : fmt::format("speed {:.4g} m/s", p.velocity.norm()));
  if (p.angular_velocity != 0) moves += fmt::format("   {:.4g} rad/s", p.angular_velocity);
  return moves;
}

}  // namespace

Rigid::Rigid(const Parameters& p) : parameters_(p), body_(p), mesh_(surface(p)) {
  arm_ = mesh_.position.colwise() - body_.centre();
  case_force_ = case_force(p.load, elastic_solid(p), mesh_);
  state_.body = body_.start();
  saved_ = state_;
}

void Rigid::advance(double t, double dt, const Load& load) {
  const Points fluid = load.mean(t, t + dt, mesh_.position.cols());
  const double ramp =
      0.5 * (ramp_factor(t, parameters_.load.ramp) + ramp_factor(t + dt, parameters_.load.ramp));
  Wrench loads, of_fluid;
  for (Eigen::Index k = 0; k < fluid.cols(); ++k) {
    of_fluid.add(arm_.col(k), fluid.col(k));
    loads.add(arm_.col(k), fluid.col(k) + ramp * case_force_.col(k));
  }
  RigidState from = state_.body;
  from.time = t;
  state_.body = body_.advance(from, dt, loads);
  const Eigen::Matrix3d mean = 0.5 * (from.turn.toRotationMatrix() + state_.body.turn.toRotationMatrix());
  state_.force = of_fluid.force;
  state_.moment =
      moment_of(of_fluid, mean) - (mean * (body_.mass().centre - body_.centre())).cross(of_fluid.force);
  ++state_.steps;
}

Points Rigid::displacement() const {
  const Eigen::Matrix3d change = state_.body.turn.toRotationMatrix() - Eigen::Matrix3d::Identity();
  return (change * arm_).colwise() + state_.body.displacement;
}

Points Rigid::velocity() const {
  const Eigen::Matrix3d R = state_.body.turn.toRotationMatrix();
  const Eigen::Vector3d turning = R * state_.body.spin;
  Points velocity(3, arm_.cols());
  for (Eigen::Index k = 0; k < arm_.cols(); ++k)
    velocity.col(k) = state_.body.velocity + turning.cross(Eigen::Vector3d(R * arm_.col(k)));
  return velocity;
}

Eigen::Vector3d Rigid::displacement_at(const Eigen::Vector3d& X) const {
  const Eigen::Vector3d r = X - body_.centre();
  return state_.body.displacement + (state_.body.turn * r - r);
}

Eigen::Vector3d Rigid::velocity_at(const Eigen::Vector3d& X) const {
  return state_.body.velocity + state_.body.turn * state_.body.spin.cross(X - body_.centre());
}

std::optional<Eigen::Vector3d> Rigid::support_displacement(const Eigen::Vector3d& X) const {
  if (!is_driven()) return std::nullopt;
  return displacement_at(X);
}

bool Rigid::is_driven() const {
  return (parameters_.motion || parameters_.angular_velocity != 0) && !parameters_.free.any();
}

Energy Rigid::energy() const {
  return {.kinetic = body_.kinetic_energy(state_.body), .strain = 0, .external = state_.body.work};
}

std::vector<std::pair<Column, double>> Rigid::report() const {
  std::vector<std::pair<Column, double>> report;
  const auto vector = [&](const std::string& name, const char* unit, const Eigen::Vector3d& value) {
    for (int axis = 0; axis < parameters_.dimension; ++axis)
      report.push_back({{name + "xyz"[axis], unit}, value[axis]});
  };
  const auto turn = [&](const std::string& name, const char* unit, const Eigen::Vector3d& value) {
    if (parameters_.dimension == 3)
      vector(name + ".", unit, value);
    else  // in the plane a turn and a moment have no direction
      report.push_back({{name, unit}, value.z()});
  };
  const Eigen::Vector3d& centre = body_.mass().centre;
  const Eigen::Vector3d turning = state_.body.turn * state_.body.spin;
  vector("body.", "m", centre + displacement_at(centre));
  turn("body.angle", "deg", turn_vector(state_.body, parameters_.dimension) / degree);
  vector("body.v", "m/s", velocity_at(centre));
  turn("body.rate", "deg/s", turning / degree);
  vector("body.f", "N", state_.force);
  turn("body.moment", "N m", state_.moment);
  return report;
}

std::vector<Column> Rigid::columns() const {
  std::vector<Column> columns;
  for (const auto& [column, value] : report()) columns.push_back(column);
  return columns;
}

std::map<std::string, double> Rigid::monitor() const {
  std::map<std::string, double> monitor;
  for (const auto& [column, value] : report()) monitor[column.name] = value;
  return monitor;
}

void Rigid::write(Archive& archive) const {
  const RigidState& body = saved_.body;
  Eigen::MatrixXd state(3, 7);
  state << body.displacement, body.velocity, body.turn.vec(), body.spin, saved_.force, saved_.moment,
      Eigen::Vector3d(body.turn.w(), body.angle, body.work);
  archive.real["rigid.state"] = state;
  archive.real["rigid.time"] = Eigen::MatrixXd::Constant(1, 1, body.time);
  archive.integer["rigid.steps"] = {saved_.steps};
}

void Rigid::read(const Archive& archive) {
  const Eigen::MatrixXd& state = archive.real.at("rigid.state");
  RigidState& body = state_.body;
  body.displacement = state.col(0);
  body.velocity = state.col(1);
  body.turn.vec() = state.col(2);
  body.spin = state.col(3);
  state_.force = state.col(4);
  state_.moment = state.col(5);
  body.turn.w() = state(0, 6);
  body.angle = state(1, 6);
  body.work = state(2, 6);
  body.time = archive.real.at("rigid.time")(0, 0);
  state_.steps = static_cast<int>(archive.integer.at("rigid.steps").at(0));
  saved_ = state_;
}

Frame Rigid::frame() const {
  return outline_frame(state_.body.time, mesh_, displacement(), velocity());
}

std::vector<std::string> Rigid::lines() const {
  const MassProperties& m = body_.mass();
  const char* per = parameters_.dimension == 2 ? " per metre of depth" : "";
  constexpr double round_off = 1e-12;
  const double none = round_off * mesh_.position.cwiseAbs().maxCoeff();
  const Eigen::Vector3d centre = (m.centre.array().abs() < none).select(0, m.centre);
  std::vector<std::string> lines = {
      fmt::format("rigid   {} interface points   {}", mesh_.position.cols(), motion_text(parameters_)),
      fmt::format("mass {:.6g} kg{}   centre of gravity ({:.6g}, {:.6g}{}) m", m.mass, per, centre.x(),
                  centre.y(), parameters_.dimension == 3 ? fmt::format(", {:.6g}", centre.z()) : "")};
  if (parameters_.dimension == 2)
    lines.back() += fmt::format("   inertia {:.6g} kg m^2", m.inertia(2, 2));
  else
    lines.back() += fmt::format("   inertia about x, y, z {:.6g}, {:.6g}, {:.6g} kg m^2", m.inertia(0, 0),
                                m.inertia(1, 1), m.inertia(2, 2));
  if (parameters_.free.any() && parameters_.body.mass == 0)
    lines.emplace_back(
        "its mass is structure.material.density times its volume: structure.mass is not given");
  const auto& file = parameters_.closed_surface.lines;
  lines.insert(lines.end(), file.begin(), file.end());
  if (body_.is_free())
    lines.push_back(fmt::format("added-mass ratio {:.3g} (flat plate of the body's width at the surface)",
                                plate_added_mass(parameters_) / m.mass));
  return lines;
}

Frame outline_frame(double time, const InterfaceMesh& mesh, const Points& displacement,
                    const Points& velocity) {
  Frame frame;
  frame.time = time;
  frame.position = mesh.position + displacement;
  frame.cells = mesh.faces;
  frame.point_data = {{"displacement", "m", displacement}, {"velocity", "m/s", velocity}};
  return frame;
}

Properties Rigid::properties() {
  const MassProperties& m = body_.mass();
  return {.mass = m.mass, .centre = m.centre, .inertia = m.inertia(2, 2), .frequencies = {}, .step = "any"};
}

}  // namespace strake::structure
