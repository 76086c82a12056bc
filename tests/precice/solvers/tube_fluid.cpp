// The flow in the elastic tube (tube.hpp): takes the area, sends the pressure. It knows preCICE's functions
// alone.
#include "band_matrix.hpp"
#include "tube.hpp"

#include <precice/precice.hpp>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

using tube::cells;
using tube::nodes;
using tube::Values;

struct Flow {
  Values a = Values(nodes, 1.0), u = Values(nodes, 10.0), p = Values(nodes, 0.0);
};

double norm(const Values& v) {
  double sum = 0;
  for (double x : v) sum += x * x;
  return std::sqrt(sum);
}

/// One time step for a given area, by Newton's method on velocity and pressure. With face values as the mean
/// of two nodes, at the inner nodes:
///   dx/dt (u_i a_i − u_iⁿ a_iⁿ) + a₊ u₊ u_i − a₋ u₋ u_(i−1) + ½ (a₊ (p_(i+1) − p_i) + a₋ (p_i − p_(i−1))) =
///   0 dx/dt (a_i − a_iⁿ) + a₊ u₊ − a₋ u₋ = 0
/// Inlet: u = 10 + 3 sin(10π t), p extrapolated. Outlet: u extrapolated, no reflection:
///   p = 2 (c² − (√(c² − pⁿ/2) − (u − uⁿ)/4)²)
class Step {
 public:
  void operator()(const Flow& before, Flow& now, double end_time, double dt) {
    double shortest = INFINITY;
    for (int newton = 0; newton < 50; ++newton) {
      linearise(before, now, end_time, tube::dx / dt);
      matrix_.solve(residual_);
      for (int i = 0; i < nodes; ++i) {
        now.u[index(i)] -= residual_[index(2 * i)];
        now.p[index(i)] -= residual_[index(2 * i + 1)];
      }
      const double change = norm(residual_), whole = std::hypot(norm(now.u), norm(now.p));
      if (change <= 1e-15 * whole || (change <= 1e-12 * whole && change >= 0.5 * shortest))
        return;  // round-off
      shortest = std::min(shortest, change);
    }
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  void linearise(const Flow& before, const Flow& now, double end_time, double rate) {
    const auto a = [&](int i) { return now.a[index(i)]; };
    const auto u = [&](int i) { return now.u[index(i)]; };
    const auto p = [&](int i) { return now.p[index(i)]; };
    const auto add = [&](int row, int column, double value) { matrix_(row, column) += value; };
    const auto velocity = [](int i) { return 2 * i; };
    const auto pressure = [](int i) { return 2 * i + 1; };
    matrix_.clear();
    residual_.assign(2 * nodes, 0.0);
    residual_[0] = u(0) - (10 + 3 * std::sin(10 * tube::pi * end_time));
    add(0, velocity(0), 1);
    residual_[1] = p(0) - 2 * p(1) + p(2);
    add(1, pressure(0), 1), add(1, pressure(1), -2), add(1, pressure(2), 1);
    for (int i = 1; i < cells; ++i) {
      const double right = (a(i) + a(i + 1)) / 2, left = (a(i - 1) + a(i)) / 2;
      const double u_right = (u(i) + u(i + 1)) / 2, u_left = (u(i - 1) + u(i)) / 2;
      residual_[index(2 * i)] = rate * (u(i) * a(i) - before.u[index(i)] * before.a[index(i)]) +
                                right * u_right * u(i) - left * u_left * u(i - 1) +
                                (right * (p(i + 1) - p(i)) + left * (p(i) - p(i - 1))) / 2;
      add(2 * i, velocity(i - 1), -left * (u_left + u(i - 1) / 2));
      add(2 * i, velocity(i), rate * a(i) + right * (u_right + u(i) / 2) - left * u(i - 1) / 2);
      add(2 * i, velocity(i + 1), right * u(i) / 2);
      add(2 * i, pressure(i - 1), -left / 2);
      add(2 * i, pressure(i), (left - right) / 2);
      add(2 * i, pressure(i + 1), right / 2);
      residual_[index(2 * i + 1)] = rate * (a(i) - before.a[index(i)]) + right * u_right - left * u_left;
      add(2 * i + 1, velocity(i - 1), -left / 2);
      add(2 * i + 1, velocity(i), (right - left) / 2);
      add(2 * i + 1, velocity(i + 1), right / 2);
    }
    residual_[index(2 * cells)] = u(cells) - 2 * u(cells - 1) + u(cells - 2);
    add(2 * cells, velocity(cells), 1), add(2 * cells, velocity(cells - 1), -2);
    add(2 * cells, velocity(cells - 2), 1);
    const double c2 = tube::squared_speed();
    const double s = std::sqrt(c2 - before.p[cells] / 2) - (u(cells) - before.u[cells]) / 4;
    residual_[index(2 * cells + 1)] = p(cells) - 2 * (c2 - s * s);
    add(2 * cells + 1, pressure(cells), 1), add(2 * cells + 1, velocity(cells), -s);
  }

  BandMatrix matrix_{2 * nodes, 4};
  Values residual_;
};

}  // namespace

/// tube_fluid CONFIG [MESH]: prints time, area and pressure in the middle after each window. MESH: the
/// pressure has a mesh of its own, whose points go backwards.
int main(int argc, char** argv) {
  precice::Participant coupling("Fluid", argc > 1 ? argv[1] : "tube.xml", 0, 1);
  const bool two = argc > 2;
  const std::string of_pressure = two ? argv[2] : "Fluid-Nodes";
  std::vector<int> ids(nodes), pressure_ids(nodes);
  coupling.setMeshVertices("Fluid-Nodes", tube::positions(), ids);
  if (two) coupling.setMeshVertices(of_pressure, tube::positions_backwards(), pressure_ids);
  const auto write = [&](const Values& p) {
    coupling.writeData(of_pressure, "Pressure", two ? pressure_ids : ids,
                       two ? Values(p.rbegin(), p.rend()) : p);
  };
  Flow now;
  if (coupling.requiresInitialData()) write(now.p);
  coupling.initialize();
  Flow before = now, saved = now;
  Step step;
  double t = 0, saved_t = 0;
  coupling.readData("Fluid-Nodes", "CrossSection", ids, 0, before.a);
  while (coupling.isCouplingOngoing()) {
    if (coupling.requiresWritingCheckpoint()) saved = before, saved_t = t;
    const double dt = coupling.getMaxTimeStepSize();
    now = before;
    coupling.readData("Fluid-Nodes", "CrossSection", ids, dt, now.a);
    step(before, now, t + dt, dt);
    write(now.p);
    coupling.advance(dt);
    if (coupling.requiresReadingCheckpoint()) {
      before = saved, t = saved_t;
    } else {
      before = now, t += dt;
      std::printf("%.4f %.9g %.9g\n", t, now.a[cells / 2], now.p[cells / 2]);
    }
  }
  coupling.finalize();
}
