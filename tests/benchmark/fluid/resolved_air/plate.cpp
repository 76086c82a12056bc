#include "tests/benchmark/fluid/resolved_air/plate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace resolved_air {

namespace {

/// Rows of one height reach this far below the still water and above the plate's face.
constexpr double fine_below = 4e-3, fine_above = 6e-3;  // [m]
/// Growth from row to row and from column to column outside the fine part.
constexpr double row_growth = 1.06, column_growth = 1.1;
constexpr double largest_row = 0.02, largest_column = 0.02;  // [m]

Sample sample_of(const Flow& flow, const PlateCase& plate) {
  const Grid& grid = flow.grid();
  double force = 0;
  for (std::size_t i = 0; i < grid.plate_columns; ++i)
    force += grid.width[i] * (flow.top_pressure()[i] - ambient_pressure);
  return {.time = flow.time() - plate.gap / plate.speed,
          .mean_pressure = force / plate.half_width,
          .centre_pressure = flow.top_pressure()[0] - ambient_pressure,
          .centre_gap = flow.air_thickness(0),
          .air_left = flow.air_under_plate() / (ambient_air * plate.half_width)};
}

/// Value of a recorded quantity at a time, linear between samples.
double at_time(const std::vector<Sample>& samples, double time, double Sample::*quantity) {
  const auto after = std::lower_bound(samples.begin(), samples.end(), time,
                                      [](const Sample& s, double t) { return s.time < t; });
  if (after == samples.begin()) return samples.front().*quantity;
  if (after == samples.end()) return samples.back().*quantity;
  const Sample &a = *(after - 1), &b = *after;
  return a.*quantity + (time - a.time) / (b.time - a.time) * (b.*quantity - a.*quantity);
}

const Sample& largest_of(const std::vector<Sample>& samples, double Sample::*quantity) {
  return *std::max_element(samples.begin(), samples.end(), [quantity](const Sample& a, const Sample& b) {
    return a.*quantity < b.*quantity;
  });
}

}  // namespace

Grid plate_grid(const PlateCase& plate) {
  Grid grid;
  std::vector<double> inner =
      graded(plate.half_width, plate.edge_column, column_growth, 8 * plate.edge_column);
  grid.width.assign(inner.rbegin(), inner.rend());
  grid.plate_columns = grid.width.size();
  const auto outer =
      graded(plate.half_tank - plate.half_width, plate.edge_column, column_growth, largest_column);
  grid.width.insert(grid.width.end(), outer.begin(), outer.end());

  // Still water at y = 0, bottom at −depth, plate at the gap. Velocities fall to 0 from the fine part down.
  const auto below = static_cast<int>(std::lround(fine_below / plate.row));
  const auto between = static_cast<int>(std::lround(plate.gap / plate.row));
  const auto beside = static_cast<int>(std::lround(fine_above / plate.row));
  const double bottom_of_fine = -below * plate.row;
  const auto down = graded(plate.depth + bottom_of_fine, plate.row, row_growth, largest_row);
  grid.face = {-plate.depth};
  for (auto w = down.rbegin(); w + 1 != down.rend(); ++w) grid.face.push_back(grid.face.back() + *w);
  for (int j = -below; j <= between + beside; ++j) grid.face.push_back(j * plate.row);
  grid.plate_row = down.size() + static_cast<std::size_t>(below + between);
  grid.face[grid.plate_row] = plate.gap;
  for (const double w : graded(plate.air_above - beside * plate.row, plate.row, row_growth, largest_row))
    grid.face.push_back(grid.face.back() + w);
  for (const double y : grid.face)
    grid.face_velocity.push_back(-plate.speed *
                                 std::min(1.0, (y + plate.depth) / (bottom_of_fine + plate.depth)));
  return grid;
}

PlateRun run_plate(const PlateCase& plate) {
  const auto begin = std::chrono::steady_clock::now();
  const Grid grid = plate_grid(plate);
  Flow flow(
      grid, [](double, double y) { return y > 0 ? 1.0 : 0.0; }, plate.slip);
  PlateRun run;
  for (std::size_t i = 0; i < grid.columns(); ++i) run.cells += grid.rows_of(i);
  const Masses before = flow.masses();
  const double end = plate.gap / plate.speed + plate.after_contact;
  while (end - flow.time() > 1e-12) {
    flow.step(end - flow.time());
    run.samples.push_back(sample_of(flow, plate));
  }
  const Masses after = flow.masses(), left = flow.left();
  run.air_error = (after.air + left.air - before.air) / before.air;
  run.water_error = (after.water + left.water - before.water) / before.water;
  run.steps = run.samples.size();
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return run;
}

const std::vector<FigureName>& figure_names() {
  static const std::vector<FigureName> names = {
      {"largest mean pressure", "kPa", 1e3},      {"time of it after contact", "ms", 1e-3},
      {"largest centre pressure", "kPa", 1e3},    {"centre pressure at -0.4 ms", "kPa", 1e3},
      {"centre pressure at -0.2 ms", "kPa", 1e3}, {"centre pressure at 0 ms", "kPa", 1e3},
      {"centre gap at -0.4 ms", "mm", 1e-3},      {"centre gap at -0.2 ms", "mm", 1e-3},
      {"centre gap at 0 ms", "mm", 1e-3},         {"air left at 0 ms", "mm", 1e-3},
      {"impulse to 0.3 ms", "rho V a", 1}};
  return names;
}

std::vector<double> figures_of(const PlateRun& run, const PlateCase& plate) {
  const std::vector<Sample>& s = run.samples;
  const Sample& peak = largest_of(s, &Sample::mean_pressure);
  std::vector<double> figures = {peak.mean_pressure, peak.time,
                                 largest_of(s, &Sample::centre_pressure).centre_pressure};
  for (const auto quantity : {&Sample::centre_pressure, &Sample::centre_gap})
    for (const double time : {-0.4e-3, -0.2e-3, 0.0}) figures.push_back(at_time(s, time, quantity));
  figures.push_back(at_time(s, 0, &Sample::air_left));
  // ∫ p dt of the mean pressure from the start, by the trapezoidal rule.
  double impulse = 0;
  for (std::size_t k = 1; k < s.size() && s[k].time <= 0.3e-3; ++k)
    impulse += 0.5 * (s[k].mean_pressure + s[k - 1].mean_pressure) * (s[k].time - s[k - 1].time);
  figures.push_back(impulse / (ambient_water * plate.speed * plate.half_width));
  return figures;
}

}  // namespace resolved_air
