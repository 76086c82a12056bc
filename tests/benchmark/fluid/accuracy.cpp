// Accuracy of the fluid's defaults on flows that have an exact solution, with the observed order.
//   fluid_accuracy_benchmark [wave|vortices|channel]…    (default: all; about two minutes of one core)
#include "fluid/simulation/simulation.hpp"
#include "tests/method/fluid/known_flows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace {

using namespace strake::fluid;
using std::numbers::pi;

Parameters laminar(double spacing, double viscosity) {
  Parameters p;
  p.spacing = spacing;
  p.tank.min = p.water.min = {0, 0, 0};
  p.tank.max = p.water.max = {1, 1, 0};
  p.sound_speed = std::numeric_limits<double>::infinity();
  p.kinematic_viscosity = viscosity;
  p.threads = 1;
  return p;
}

/// Relative error of the period of a standing wave (cases/VALIDATION.md, "Standing wave").
double wave_period_error(double spacing) {
  Parameters p = laminar(spacing, 1e-6);
  p.tank.max[1] = 0.8;
  p.water.max[1] = StandingWave::depth;
  Simulation<2> simulation(p, {}, {});
  StandingWave::start(simulation);
  const std::vector<double> zero = StandingWave::zeros(simulation, 5, 4);
  return zero.size() == 5 ? 0.5 * (zero[4] - zero[0]) / StandingWave::period() - 1 : std::nan("");
}

void waves() {
  fmt::print("standing wave, period against 0.8018 s over two periods\n  {:>10} {:>10} {:>8}\n", "l0 [mm]",
             "error", "order");
  double before = 0;
  for (const double l0 : {0.05, 0.025, 0.0125, 0.00625}) {
    const double error = wave_period_error(l0);
    fmt::print("  {:10.3f} {:+9.2f} % {:>7}\n", 1e3 * l0, 100 * error,
               before != 0 ? fmt::format("{:.2f}", std::log2(std::abs(before / error))) : "");
    std::fflush(stdout);
    before = error;
  }
}

/// cases/VALIDATION.md, "Viscous flows": four vortices at Re 100; rate of their energy's decay over 16π²ν,
/// and the velocity's L2 error.
void vortices() {
  fmt::print("Taylor-Green vortices at Re 100 in a smooth box, t = 1\n  {:>10} {:>12} {:>12}\n", "across",
             "decay rate", "L2 of u");
  constexpr double viscosity = 0.01;
  for (const int across : {25, 50, 100}) {
    Parameters p = laminar(1.0 / across, viscosity);
    p.open_top = false;
    p.gravity.setZero();
    p.scheme.turbulence = Turbulence::none;
    Simulation<2> simulation(p, {}, {});
    const State<2>& state = simulation.state();
    const std::int64_t water = water_of(state);
    const auto exact = [](const Vector<2>& x, double t) {
      const double size = std::exp(-8 * pi * pi * viscosity * t);
      return Vector<2>(size * std::sin(2 * pi * x[0]) * std::cos(2 * pi * x[1]),
                       -size * std::cos(2 * pi * x[0]) * std::sin(2 * pi * x[1]));
    };
    State<2> turning = state;
    for (std::int64_t i = 0; i < water; ++i) turning.velocity.col(i) = exact(state.position.col(i), 0);
    simulation.set_state(turning);
    const double start = state.velocity.leftCols(water).squaredNorm();
    while (state.time < 1) simulation.step(simulation.stable_dt(), {});
    double off = 0, all = 0;
    for (std::int64_t i = 0; i < water; ++i) {
      const Vector<2> u = exact(state.position.col(i), state.time);
      off += (state.velocity.col(i) - u).squaredNorm();
      all += u.squaredNorm();
    }
    const double rate = -std::log(state.velocity.leftCols(water).squaredNorm() / start) / state.time;
    fmt::print("  {:10} {:12.4f} {:12.4f}\n", across, rate / (16 * pi * pi * viscosity),
               std::sqrt(off / all));
    std::fflush(stdout);
  }
}

/// cases/VALIDATION.md, "Viscous flows": L2 error of the start-up between rough plates, times in h²/ν.
void channel() {
  fmt::print("channel between rough plates, 20 particles across\n  {:>10} {:>12}\n", "t nu/h^2", "L2 of u");
  Parameters p = laminar(1.0 / 20, 1);
  p.open_top = false;
  p.periodic[0] = true;
  p.wall = WallSlip::no_slip;
  p.gravity = {1, 0, 0};
  p.scheme.turbulence = Turbulence::none;
  Simulation<2> simulation(p, {}, {});
  const State<2>& state = simulation.state();
  for (const double stop : {0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 4.0}) {
    while (state.time < stop - 1e-12)
      simulation.step(std::min(simulation.stable_dt(), stop - state.time), {});
    fmt::print("  {:10.2f} {:12.4f}\n", stop, channel_error(state));
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> asked(argv + 1, argv + argc);
  const auto wanted = [&](const char* name) {
    return asked.empty() || std::find(asked.begin(), asked.end(), name) != asked.end();
  };
  if (wanted("wave")) waves();
  if (wanted("vortices")) vortices();
  if (wanted("channel")) channel();
}
