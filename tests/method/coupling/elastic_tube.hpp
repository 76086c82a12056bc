#pragma once

#include "tests/algebra/factors.hpp"
#include "tests/method/coupling/coupling_models.hpp"

#include <cmath>
#include <vector>

namespace strake::models {

/// Flow through a straight elastic tube, one-dimensional, with n cells over 10 m. Unit density, wall
/// stiffness 1e4, radius 1/√π, outlet without reflection. Area a [m²], velocity u [m/s] and pressure p [Pa]
/// at the nodes; steps of 0.01 s by the implicit Euler rule.
struct Tube {
  static constexpr int cells = 100, nodes = cells + 1;
  static constexpr double dx = 0.1, dt = 0.01;
  static double squared_speed() { return 1e4 / (2 / std::sqrt(M_PI)); }  // c² = E/(2 r0)
};

/// a = (2c²)²/(p − 2c²)²
inline Eigen::VectorXd tube_area(const Eigen::VectorXd& pressure) {
  const double limit = 2 * Tube::squared_speed();
  return (limit * limit / (pressure.array() - limit).square()).matrix();
}

/// The flow at one time.
struct TubeFlow {
  Eigen::VectorXd area = Eigen::VectorXd::Ones(Tube::nodes),
                  velocity = Eigen::VectorXd::Constant(Tube::nodes, 10),
                  pressure = Eigen::VectorXd::Zero(Tube::nodes);
};

/// One step of the flow through a tube of given area, Newton on velocity and pressure together. With face
/// values as the mean of two nodes, momentum and continuity at the inner nodes:
///   dx/dt (u_i a_i − u_iⁿ a_iⁿ) + a₊ u₊ u_i − a₋ u₋ u_(i−1) + ½ (a₊ (p_(i+1) − p_i) + a₋ (p_i − p_(i−1))) =
///   0 dx/dt (a_i − a_iⁿ) + a₊ u₊ − a₋ u₋ = 0
/// Inlet u = 10 + 3 sin(10π t) and p extrapolated; outlet u extrapolated and
///   p = 2 (c² − (√(c² − pⁿ/2) − (u − uⁿ)/4)²)
class TubeStep {
 public:
  TubeFlow operator()(const TubeFlow& before, const Eigen::VectorXd& area, double end_time) {
    TubeFlow now = before;
    now.area = area;
    double shortest = INFINITY;
    for (int newton = 0; newton < 50; ++newton) {
      linearise(before, now, end_time);
      if (!factors_.compute(jacobian_)) {  // an area without a flow: the coupling names what is not finite
        now.pressure.setConstant(NAN);
        break;
      }
      const Eigen::VectorXd change = factors_.solve(residual_);
      for (int i = 0; i < Tube::nodes; ++i) {
        now.velocity[i] -= change[2 * i];
        now.pressure[i] -= change[2 * i + 1];
      }
      const double size = change.norm(), whole = std::hypot(now.velocity.norm(), now.pressure.norm());
      // At round-off a step no longer falls.
      if (size <= 1e-15 * whole || (size <= 1e-12 * whole && size >= 0.5 * shortest)) break;
      shortest = std::min(shortest, size);
    }
    return now;
  }

 private:
  void linearise(const TubeFlow& before, const TubeFlow& now, double end_time) {
    const auto &a = now.area, &u = now.velocity, &p = now.pressure;
    constexpr int last = Tube::cells;
    entries_.clear();
    const auto add = [&](int row, int column, double value) { entries_.emplace_back(row, column, value); };
    const auto U = [](int i) { return 2 * i; };
    const auto P = [](int i) { return 2 * i + 1; };
    residual_.resize(2 * Tube::nodes);

    residual_[0] = u[0] - (10 + 3 * std::sin(10 * M_PI * end_time));
    add(0, U(0), 1);
    residual_[1] = p[0] - 2 * p[1] + p[2];
    add(1, P(0), 1), add(1, P(1), -2), add(1, P(2), 1);
    for (int i = 1; i < last; ++i) {
      const double right = 0.5 * (a[i] + a[i + 1]), left = 0.5 * (a[i - 1] + a[i]);
      const double u_right = 0.5 * (u[i] + u[i + 1]), u_left = 0.5 * (u[i - 1] + u[i]);
      constexpr double rate = Tube::dx / Tube::dt;
      const int momentum = 2 * i, continuity = 2 * i + 1;
      residual_[momentum] = rate * (u[i] * a[i] - before.velocity[i] * before.area[i]) +
                            right * u_right * u[i] - left * u_left * u[i - 1] +
                            0.5 * (right * (p[i + 1] - p[i]) + left * (p[i] - p[i - 1]));
      add(momentum, U(i - 1), -left * (u_left + 0.5 * u[i - 1]));
      add(momentum, U(i), rate * a[i] + right * (u_right + 0.5 * u[i]) - 0.5 * left * u[i - 1]);
      add(momentum, U(i + 1), 0.5 * right * u[i]);
      add(momentum, P(i - 1), -0.5 * left);
      add(momentum, P(i), 0.5 * (left - right));
      add(momentum, P(i + 1), 0.5 * right);
      residual_[continuity] = rate * (a[i] - before.area[i]) + right * u_right - left * u_left;
      add(continuity, U(i - 1), -0.5 * left);
      add(continuity, U(i), 0.5 * (right - left));
      add(continuity, U(i + 1), 0.5 * right);
    }
    const double speed = Tube::squared_speed();
    const double s =
        std::sqrt(speed - 0.5 * before.pressure[last]) - 0.25 * (u[last] - before.velocity[last]);
    residual_[2 * last] = u[last] - 2 * u[last - 1] + u[last - 2];
    add(2 * last, U(last), 1), add(2 * last, U(last - 1), -2), add(2 * last, U(last - 2), 1);
    residual_[2 * last + 1] = p[last] - 2 * (speed - s * s);
    add(2 * last + 1, P(last), 1), add(2 * last + 1, U(last), -s);
    jacobian_.resize(2 * Tube::nodes, 2 * Tube::nodes);
    jacobian_.setFromTriplets(entries_.begin(), entries_.end());
  }

  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::SparseMatrix<double> jacobian_;
  Eigen::VectorXd residual_;
  SparseFactors factors_;
};

inline InterfaceMesh tube_mesh(const std::string& name) {
  InterfaceMesh mesh = line_of_points(name, Tube::nodes);
  mesh.position *= Tube::dx;
  return mesh;
}

inline Field tube_field(const std::string& quantity, const std::string& unit, const Eigen::VectorXd& value) {
  return {quantity, unit, false, value.transpose()};
}

/// The flow as a participant: takes the area [m²], sends the pressure [Pa].
class TubeFluid : public Model<TubeFlow> {
 public:
  TubeFluid() {
    begin(tube_mesh("fluid"), {});
    description_.initial = {tube_field("pressure", "Pa", now_.pressure)};
  }

 private:
  Advanced step(const Window& window, const Input& input) override {
    const Eigen::VectorXd area = find(input.samples.front().fields, "area")->value.row(0).transpose();
    now_ = step_(now_, area, window.t + window.dt);
    Advanced advanced;
    advanced.output = {tube_field("pressure", "Pa", now_.pressure)};
    return advanced;
  }
  TubeStep step_;
};

/// The wall as a participant: takes the pressure, sends the area.
class TubeWall : public Model<Eigen::VectorXd> {
 public:
  TubeWall() {
    begin(tube_mesh("structure"), Eigen::VectorXd::Ones(Tube::nodes));
    description_.initial = {tube_field("area", "m^2", now_)};
  }

 private:
  Advanced step(const Window&, const Input& input) override {
    now_ = tube_area(find(input.samples.front().fields, "pressure")->value.row(0).transpose());
    Advanced advanced;
    advanced.output = {tube_field("area", "m^2", now_)};
    return advanced;
  }
};

}  // namespace strake::models
