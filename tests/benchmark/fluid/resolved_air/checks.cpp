#include "tests/benchmark/fluid/resolved_air/plate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace resolved_air {

namespace {

bool report(const char* what, double found, double expected, double error, double bound) {
  const bool good = std::abs(error) <= bound;
  std::printf("  %-52s %14.6g %14.6g  error %9.2e  bound %8.1e  %s\n", what, found, expected, error, bound,
              good ? "good" : "BAD");
  return good;
}

/// A closed column of the given height in rows of one height; its top is a wall that moves down.
Grid column(double height, int rows, double speed) {
  Grid grid;
  grid.width = {1};
  for (int j = 0; j <= rows; ++j) {
    grid.face.push_back(height * j / rows);
    grid.face_velocity.push_back(-speed * j / rows);
  }
  grid.top = Top::wall;
  return grid;
}

void run_to(Flow& flow, double end) {
  while (end - flow.time() > 1e-13) flow.step(end - flow.time());
}

/// Water that a wall meets at a speed V: p = ρ c V (Joukowsky 1898).
bool acoustic_impact() {
  constexpr double speed = 6.26, height = 0.5;
  Flow flow(column(height, 200, speed), [](double, double) { return 0.0; });
  run_to(flow, 0.5 * height / water_sound);
  const double expected = ambient_water * water_sound * speed;
  const double found = flow.top_pressure()[0] - ambient_pressure;
  return report("pressure of an impact on water, rho c V [Pa]", found, expected, found / expected - 1, 0.01);
}

/// Water and air at rest in a slanted heap, on stretched rows that move: nothing may start to flow.
bool rest() {
  Grid grid;
  grid.width = graded(0.2, 1e-3, 1.1, 0.02);
  grid.face = {0};
  for (const double w : graded(0.1, 1e-3, 1.06, 0.01)) grid.face.push_back(grid.face.back() + w);
  for (const double y : grid.face) grid.face_velocity.push_back(-20 * y / grid.face.back());
  Flow flow(grid, [](double x, double y) { return y > 0.05 - 0.1 * x ? 1.0 : 0.0; });
  const Masses before = flow.masses();
  run_to(flow, 1e-3);
  double velocity = 0, pressure = 0;
  for (std::size_t i = 0; i < grid.columns(); ++i)
    for (std::size_t j = 0; j < grid.rows(); ++j) {
      const Cell& cell = flow.cell(i, j);
      velocity = std::max(
          velocity, std::hypot(std::max(std::abs(cell.along_air), std::abs(cell.along_water)), cell.up));
      pressure = std::max(pressure, std::abs(cell.pressure - ambient_pressure));
    }
  const Masses after = flow.masses(), left = flow.left();
  const double air = (after.air + left.air - before.air) / before.air;
  const double water = (after.water + left.water - before.water) / before.water;
  bool good = report("fluids at rest on moving rows: velocity [m/s]", velocity, 0, velocity, 1e-7);
  good &= report("fluids at rest on moving rows: pressure [Pa]", pressure, 0, pressure, 1e-3);
  good &= report("mass of the air, outflow counted", 1 + air, 1, air, 1e-12);
  good &= report("mass of the water, outflow counted", 1 + water, 1, water, 1e-12);
  return good;
}

/// Mean pressure over a closed column.
double mean_pressure(const Flow& flow) {
  double sum = 0;
  for (std::size_t j = 0; j < flow.grid().rows(); ++j)
    sum += (flow.height(j + 1) - flow.height(j)) * flow.cell(0, j).pressure;
  return sum / (flow.height(flow.grid().rows()) - flow.height(0));
}

/// Air alone, slowly pressed to half its height: p = p0 2^1.4.
bool sealed_air() {
  constexpr double speed = 1, height = 0.012;
  Flow flow(column(height, 48, speed), [](double, double) { return 1.0; });
  run_to(flow, 0.5 * height / speed);
  const double expected = ambient_pressure * std::pow(2, air_exponent), found = mean_pressure(flow);
  return report("air pressed to half its height [Pa]", found, expected, found / expected - 1, 0.005);
}

/// Air above water in a closed column: h_a(p) + h_w(p) = h at equal pressure, found by bisection.
bool sealed_air_over_water() {
  constexpr double speed = 0.2, air = 0.012, water = 0.012, pressed = 0.006;
  Flow flow(column(air + water, 96, speed), [](double, double y) { return y > water ? 1.0 : 0.0; });
  const Masses before = flow.masses();
  run_to(flow, pressed / speed);
  double low = ambient_pressure, high = 10 * ambient_pressure;
  for (int i = 0; i < 100; ++i) {
    const double p = 0.5 * (low + high);
    const double height = air * ambient_air / air_density(p) + water * ambient_water / water_density(p);
    (height > air + water - pressed ? low : high) = p;
  }
  const double found = mean_pressure(flow);
  bool good = report("air pressed over water to half its height [Pa]", found, low, found / low - 1, 0.005);
  const double error = flow.masses().air / before.air - 1;
  return report("mass of the air over water", 1 + error, 1, error, 1e-12) && good;
}

/// A wind over water at rest, whose level surface crosses the rows: the air keeps its momentum.
/// The top is open. The columns are so wide that nothing comes from their ends.
bool wind(const char* what, Slip slip, double bound) {
  constexpr double speed = 6.26, height = 0.024, velocity = 100;
  Grid grid = column(height, 48, speed);
  grid.width.assign(5, 1e4);
  grid.top = Top::open;
  Flow flow(
      grid, [](double, double y) { return y > 0.5 * height ? 1.0 : 0.0; }, slip);
  flow.set_air_velocity(velocity);
  run_to(flow, 1e-3);
  double found = 0, width = 0;
  for (std::size_t j = 0; j < grid.rows(); ++j) {
    const Cell& cell = flow.cell(2, j);
    found += cell.fraction * cell.along_air;
    width += cell.fraction;
  }
  found /= width;
  return report(what, found, velocity, found / velocity - 1, bound);
}

/// A tube of air bursts: left 4 p0, right p0. Both waves are known from the barotropic laws of shock and fan.
bool burst() {
  constexpr double ratio = 4;
  // Fan: u = 2/(γ−1) (c_l − c); shock: u² = (p − p0)(1/ρ0 − 1/ρ); both meet at p*, by bisection.
  const auto sound = [](double p) { return std::sqrt(air_exponent * p / air_density(p)); };
  double low = ambient_pressure, high = ratio * ambient_pressure;
  for (int i = 0; i < 100; ++i) {
    const double p = 0.5 * (low + high);
    const double fan = 2 / (air_exponent - 1) * (sound(ratio * ambient_pressure) - sound(p));
    const double shock = std::sqrt((p - ambient_pressure) * (1 / ambient_air - 1 / air_density(p)));
    (fan > shock ? low : high) = p;
  }
  Flow flow(column(1, 400, 0), [](double, double) { return 1.0; });
  flow.set_air_pressure([](double, double y) { return (y < 0.5 ? ratio : 1) * ambient_pressure; });
  run_to(flow, 0.6e-3);
  const double found = flow.cell(0, 210).pressure;
  return report("pressure between the waves of a burst [Pa]", found, low, found / low - 1, 0.005);
}

}  // namespace

bool self_checks() {
  std::printf("  %-52s %14s %14s\n", "check", "found", "expected");
  bool good = acoustic_impact();
  good &= rest();
  good &= sealed_air();
  good &= sealed_air_over_water();
  good &= wind("wind over water that crosses rows [m/s]", Slip::free, 1e-3);
  wind("the same with one velocity for both, no bound", Slip::none, 1);
  good &= burst();
  return good;
}

}  // namespace resolved_air
