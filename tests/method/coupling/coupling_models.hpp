#pragma once

#include "proto/participant.hpp"
#include "tests/algebra/factors.hpp"

#include <Eigen/Core>

#include <string>
#include <utility>

namespace strake::models {

/// A participant whose state is one value: rewind is an assignment.
template <class State>
class Model : public Participant {
 public:
  const InterfaceMesh& mesh() const override { return mesh_; }
  const Description& description() const override { return description_; }
  void start(const Window& window, const Input& input) override { answer_ = step(window, input); }
  Advanced finish() override { return answer_; }
  void rewind() override { now_ = committed_; }
  void commit(bool) override { committed_ = now_; }
  void checkpoint(const std::filesystem::path&) override {}
  void resume(const std::filesystem::path&) override {}
  const State& state() const { return now_; }

 protected:
  virtual Advanced step(const Window&, const Input&) = 0;
  void begin(InterfaceMesh mesh, State state) {
    mesh_ = std::move(mesh);
    now_ = committed_ = std::move(state);
  }
  InterfaceMesh mesh_;
  Description description_;
  State now_, committed_;

 private:
  Advanced answer_;
};

/// n points on the x axis that move in y.
inline InterfaceMesh line_of_points(const std::string& name, Eigen::Index n) {
  InterfaceMesh mesh = {name, 2, Points::Zero(3, n), {}, {}};
  for (Eigen::Index i = 0; i < n; ++i) mesh.position(0, i) = static_cast<double>(i);
  return mesh;
}

inline Field y_field(const std::string& quantity, const std::string& unit, const Eigen::VectorXd& y) {
  Field field = {quantity, unit, quantity == "force", Eigen::MatrixXd::Zero(3, y.size())};
  field.value.edit().row(1) = y;
  return field;
}

inline Eigen::VectorXd y_of(const Input& input, const std::string& quantity) {
  return find(input.samples.front().fields, quantity)->value.row(1).transpose();
}

/// Motion of n points.
struct Motions {
  Eigen::VectorXd x, v, a;
};

enum class Rule {
  trapezoidal,  // v' = 2(x' − x)/dt − v, a mean over the window; Newmark β = 1/4, γ = 1/2
  backward      // v' = (x' − x)/dt, a' = (v' − v)/dt (BDF1)
};

/// An incompressible fluid as its added mass: f = −M_a a on points that move with the interface.
class AddedMass : public Model<Motions> {
 public:
  AddedMass(Eigen::MatrixXd mass, const Eigen::VectorXd& v0, Rule rule)
      : mass_(std::move(mass)), rule_(rule) {
    begin(line_of_points("fluid", v0.size()), {Eigen::VectorXd::Zero(v0.size()), v0, {}});
  }
  /// Where its points are at the start.
  void place(const Eigen::VectorXd& x0) { now_.x = committed_.x = x0; }

 private:
  Advanced step(const Window& window, const Input& input) override {
    const Eigen::VectorXd x = y_of(input, "displacement"), before = now_.v;
    const Eigen::VectorXd secant = (x - now_.x) / window.dt;
    if (rule_ == Rule::backward)
      now_.v = secant;
    else if (find(input.samples.front().fields, "velocity"))
      now_.v = y_of(input, "velocity");
    else
      now_.v = 2 * secant - before;
    now_.x = x;
    Advanced advanced;
    advanced.output = {y_field("force", "N", -mass_ * (now_.v - before) / window.dt)};
    return advanced;
  }
  Eigen::MatrixXd mass_;
  Rule rule_;
};

/// M x'' + K x = f.
class Oscillators : public Model<Motions> {
 public:
  Oscillators(Eigen::MatrixXd mass, Eigen::MatrixXd stiffness, const Eigen::VectorXd& x0,
              const Eigen::VectorXd& v0, Rule rule, bool send_velocity = false)
      : mass_(std::move(mass)), stiffness_(std::move(stiffness)), rule_(rule), send_velocity_(send_velocity) {
    description_.initial = {y_field("displacement", "m", x0), y_field("velocity", "m/s", v0)};
    begin(line_of_points("structure", x0.size()), {x0, v0, {}});
  }

 private:
  Advanced step(const Window& window, const Input& input) override {
    const double dt = window.dt;
    const Eigen::VectorXd force = y_of(input, "force");
    Eigen::VectorXd x;
    if (rule_ == Rule::trapezoidal) {
      // Mean force over the window: M (v' − v)/dt + K (x + x')/2 = f, v' = 2(x' − x)/dt − v
      const Eigen::MatrixXd left = mass_ * (2 / (dt * dt)) + 0.5 * stiffness_;
      x = now_.x + solution_of(left, force + mass_ * (2 / dt) * now_.v - stiffness_ * now_.x);
      now_.v = 2 * (x - now_.x) / dt - now_.v;
    } else {
      // M (x' − x − dt v)/dt² + K x' = f
      const Eigen::MatrixXd left = mass_ / (dt * dt) + stiffness_;
      x = solution_of(left, force + mass_ * (now_.x + dt * now_.v) / (dt * dt));
      now_.v = (x - now_.x) / dt;
    }
    now_.x = x;
    Advanced advanced;
    advanced.output = {y_field("displacement", "m", now_.x)};
    if (send_velocity_) advanced.output.push_back(y_field("velocity", "m/s", now_.v));
    return advanced;
  }
  Eigen::MatrixXd mass_, stiffness_;
  Rule rule_;
  bool send_velocity_;
};

}  // namespace strake::models
